#version 450
#extension GL_GOOGLE_include_directive : require
// Intersects every ray of all due lane edge sensors with road markings in pixels, in one dispatch. Keeps the nearer of
// the raster's hit and the cast's hit.

#include "shaders/sensors/laneedge.glsl"
#include "shaders/raycast/records.glsl"

layout(local_size_x = SF_LANES_PER_GROUP) in;  // raycast/records.h
layout(constant_id = 0) const bool kRounds32 = true;  // device property: lib/exact32.glsl
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;          // RasterRow of each sensor
layout(binding = 1, r32ui) uniform readonly uimageBuffer lanes;            // Lane of each lane
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer directions64;  // BeamDirection of each beam, actual
layout(binding = 3, r32ui) uniform readonly uimageBuffer directory;        // one word per block
layout(binding = 4, r32ui) uniform readonly uimageBuffer blocks;           // four words per block with paint
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer ranges;        // LaneRanges of each lane
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer hits;          // LaneHits of each lane: tags
layout(binding = 7, rgba32ui) uniform readonly uimageBuffer edges;         // EdgeRow of each sensor
layout(binding = 8, rgba32ui) uniform readonly uimageBuffer directions;    // BeamDirection of each beam, nominal
layout(binding = 9, rgba32f) uniform readonly imageBuffer normals;         // one texel per lane: normal deviates
layout(binding = 10, rgba32ui) uniform writeonly uimageBuffer points;      // EdgePoint of each beam

#include "shaders/lib/edge_point.glsl"
#include "shaders/lib/raster_walk.glsl"

void main() {
  const int ray = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const int lane = ray / SF_BEAMS_PER_LANE;
  const int slot = ray & (SF_BEAMS_PER_LANE - 1);
  const Lane due = load_Lane(lanes, lane);
  const RasterRow row = load_RasterRow(rows, int(due.row));
  const int own = int(due.lane);

  const BeamDirection bearing = load_BeamDirection(directions64, SF_BEAMS_PER_LANE * (int(row.beams) + own) + slot);
  precise double dx = row.heading_cos * bearing.cos - row.heading_sin * bearing.sin;
  precise double dy = row.heading_sin * bearing.cos + row.heading_cos * bearing.sin;
  const vec2 from = vec2(row.x, row.y);
  const ivec2 size = ivec2(row.columns, row.rows);
  const Walk w = walk(ivec2(row.column, row.row), from, vec2(float(dx), float(dy)), row.reach, size, row.column >= 0);

  // Computes the range of the hit in 64 bits.
  const double span = w.across_x ? double(w.face) - double(from.x) : double(w.face) - double(from.y);
  const double along = w.across_x ? dx : dy;
  precise double t = span / (along == 0.0 ? 1.0 : along);
  precise double paint_range = max(t, 0.0) * row.cell;
  const Cell painted = cell_at(w.paint, size);
  const uint ends = imageLoad(blocks, painted.bits + 2).x;
  const uint is_end = painted.full ? (ends >> (((w.paint.y & 3) << 3) | (w.paint.x & 7))) & 1u : 0u;
  const bool met = w.met && paint_range < row.range_max;

  const dvec4 four_ranges = load_LaneRanges(ranges, int(row.lane) + own).range;
  const double cast_range = slot < 2 ? (slot == 0 ? four_ranges.x : four_ranges.y) : (slot == 2 ? four_ranges.z : four_ranges.w);
  const uvec4 four = load_LaneHits(hits, int(row.lane) + own).model;
  const uint cast_tag = slot < 2 ? (slot == 0 ? four.x : four.y) : (slot == 2 ? four.z : four.w);
  const bool cast_wins = (row.flags & SF_EDGE_CAST) != 0u && cast_tag != SF_NO_HIT && (!met || cast_range < paint_range);
  const double range = cast_wins ? cast_range : met ? paint_range : row.range_max;
  const uint tag = cast_wins ? cast_tag : met ? row.tag | is_end * SF_TAG_END : SF_NO_HIT;
  const EdgeRow point = load_EdgeRow(edges, int(due.row));
  const vec4 deviates = imageLoad(normals, int(point.noise) + own);
  const float deviate = slot < 2 ? (slot == 0 ? deviates.x : deviates.y) : (slot == 2 ? deviates.z : deviates.w);
  write_point(point, own, slot, deviate, range, tag);
}
