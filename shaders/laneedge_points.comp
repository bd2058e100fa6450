#version 450
#extension GL_GOOGLE_include_directive : require
// Points from the hits of the cast: every lane of four beams of all due lane edge sensors, in one dispatch.

#include "sensors/laneedge.h"
#include "raycast/records.h"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer edges;       // SF_EDGE_TEXELS per sensor: EdgeRow
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer directions;  // one texel per beam: cosine and sine of its bearing
layout(binding = 2, rgba32f) uniform readonly imageBuffer normals;       // one texel per lane: normal deviates
layout(binding = 3, rgba32ui) uniform writeonly uimageBuffer points;     // one texel per beam: x, y [m], pixel size in the last bits of x
layout(binding = 4, r32ui) uniform readonly uimageBuffer lanes;          // two words per lane: Lane
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer ranges;      // two texels per lane: four doubles [m]
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer hits;        // one texel per lane: four tags

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
