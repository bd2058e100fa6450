#version 450
#extension GL_GOOGLE_include_directive : require
// Converts the hits of the cast to points: every lane of four beams of all due lane edge sensors, in one dispatch.

#include "shaders/sensors/laneedge.glsl"
#include "shaders/raycast/records.glsl"

layout(local_size_x = SF_LANES_PER_GROUP) in;  // raycast/records.h
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer edges;       // EdgeRow of each sensor
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer directions;  // BeamDirection of each beam
layout(binding = 2, rgba32f) uniform readonly imageBuffer normals;       // one texel per lane: normal deviates
layout(binding = 3, rgba32ui) uniform writeonly uimageBuffer points;     // EdgePoint of each beam
layout(binding = 4, r32ui) uniform readonly uimageBuffer lanes;          // Lane of each lane
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer ranges;      // LaneRanges of each lane
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer hits;        // LaneHits of each lane: tags

#include "shaders/lib/edge_point.glsl"

void main() {
  const int lane = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const Lane due = load_Lane(lanes, lane);
  const EdgeRow row = load_EdgeRow(edges, int(due.row));
  const int own = int(due.lane);
  const dvec4 range = load_LaneRanges(ranges, int(row.lane) + own).range;
  const uvec4 met = load_LaneHits(hits, int(row.lane) + own).model;
  const vec4 deviates = imageLoad(normals, int(row.noise) + own);
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) write_point(row, own, i, deviates[i], range[i], met[i]);
}
