#version 450
#extension GL_GOOGLE_include_directive : require
// What the cast met, as points: every lane of four rays of every lane edge sensor that is due, in one
// dispatch.

#include "sensors/laneedge.h"
#include "raycast/records.h"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer edges;       // SF_EDGE_TEXELS a sensor: EdgeRow
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer directions;  // a texel a beam: cosine, sine of its bearing
layout(binding = 2, rgba32f) uniform readonly imageBuffer normals;       // a texel a lane: normal deviates
layout(binding = 3, rgba32ui) uniform writeonly uimageBuffer points;     // a texel a beam: x, y [m], its grain in x
layout(binding = 4, r32ui) uniform readonly uimageBuffer lanes;          // two words a lane: Lane
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer ranges;      // two texels a lane: four doubles [m]
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer hits;        // a texel a lane: four tags

#include "shaders/lib/edge_point.glsl"

void main() {
  const int lane = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const int own = int(imageLoad(lanes, 2 * lane + 1).x);
  const PointRow row = point_row(int(imageLoad(lanes, 2 * lane).x));
  const int at = int(row.where.x) + own;
  const uvec4 two = imageLoad(ranges, 2 * at);
  const uvec4 more = imageLoad(ranges, 2 * at + 1);
  const uvec4 met = imageLoad(hits, at);
  const vec4 deviates = imageLoad(normals, row.noise + own);
  write_point(row, own, 0, deviates.x, packDouble2x32(two.xy), met.x);
  write_point(row, own, 1, deviates.y, packDouble2x32(two.zw), met.y);
  write_point(row, own, 2, deviates.z, packDouble2x32(more.xy), met.z);
  write_point(row, own, 3, deviates.w, packDouble2x32(more.zw), met.w);
}
