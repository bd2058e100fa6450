#version 450
#extension GL_GOOGLE_include_directive : require
// Road markings in pixels: every ray of all due lane edge sensors, in one dispatch. The nearer of the raster's hit and
// the cast's hit counts.

#include "sensors/laneedge.h"
#include "raycast/records.h"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;          // SF_RASTER_TEXELS per sensor: RasterRow
layout(binding = 1, r32ui) uniform readonly uimageBuffer lanes;            // two words per lane: Lane
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer directions64;  // one texel per beam: cosine and sine of its actual bearing
layout(binding = 3, r32ui) uniform readonly uimageBuffer directory;        // one word per block
layout(binding = 4, r32ui) uniform readonly uimageBuffer blocks;           // four words per block with paint
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer ranges;        // two texels per lane: four doubles [m]
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer hits;          // one texel per lane: four tags
layout(binding = 7, rgba32ui) uniform readonly uimageBuffer edges;         // SF_EDGE_TEXELS per sensor: EdgeRow
layout(binding = 8, rgba32ui) uniform readonly uimageBuffer directions;    // one texel per beam: cosine and sine of its nominal bearing
layout(binding = 9, rgba32f) uniform readonly imageBuffer normals;         // one texel per lane: normal deviates
layout(binding = 10, rgba32ui) uniform writeonly uimageBuffer points;      // one texel per beam: x, y [m], pixel size in the last bits of x

#include "shaders/lib/edge_point.glsl"
#include "shaders/lib/raster_walk.glsl"

void main() {
  const int ray = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const int lane = ray / SF_BEAMS_PER_LANE;
  const int slot = ray & (SF_BEAMS_PER_LANE - 1);
  const int due = int(imageLoad(lanes, 2 * lane).x);
  const int row = SF_RASTER_TEXELS * due;
  const int own = int(imageLoad(lanes, 2 * lane + 1).x);
  const uvec4 place = imageLoad(rows, row);
  const uvec4 heading = imageLoad(rows, row + 1);
  const uvec4 tables = imageLoad(rows, row + 2);
  const uvec4 sizes = imageLoad(rows, row + 3);
  const uvec4 rest = imageLoad(rows, row + 4);

  const double hc = packDouble2x32(heading.xy), hs = packDouble2x32(heading.zw);
  const uvec4 bearing = imageLoad(directions64, SF_BEAMS_PER_LANE * (int(tables.y) + own) + slot);
  const double bc = packDouble2x32(bearing.xy), bs = packDouble2x32(bearing.zw);
  precise double dx = hc * bc - hs * bs;
  precise double dy = hs * bc + hc * bs;
  const ivec2 start = ivec2(place.xy);
  const vec2 from = uintBitsToFloat(place.zw);
  const ivec2 size = ivec2(rest.yz);
  const Walk w = walk(start, from, vec2(float(dx), float(dy)), uintBitsToFloat(tables.w), size, start.x >= 0);

  // The range of the hit, in 64 bits.
  const double span = w.across_x ? double(w.face) - double(from.x) : double(w.face) - double(from.y);
  const double along = w.across_x ? dx : dy;
  precise double t = span / (along == 0.0 ? 1.0 : along);
  const double cell = packDouble2x32(sizes.xy), range_max = packDouble2x32(sizes.zw);
  precise double paint_range = max(t, 0.0) * cell;
  const Cell painted = cell_at(w.paint, size);
  const uint ends = imageLoad(blocks, painted.bits + 2).x;
  const uint is_end = painted.full ? (ends >> (((w.paint.y & 3) << 3) | (w.paint.x & 7))) & 1u : 0u;
  const bool met = w.met && paint_range < range_max;

  const int out_lane = int(tables.x) + own;
  const int result = SF_BEAMS_PER_LANE * out_lane + slot;
  const uvec4 pair = imageLoad(ranges, result >> 1);
  const double cast_range = packDouble2x32((result & 1) == 0 ? pair.xy : pair.zw);
  const uvec4 four = imageLoad(hits, out_lane);
  const uint cast_tag = slot < 2 ? (slot == 0 ? four.x : four.y) : (slot == 2 ? four.z : four.w);
  const bool cast_wins = (tables.z & SF_EDGE_CAST) != 0u && cast_tag != SF_NO_HIT && (!met || cast_range < paint_range);
  const double range = cast_wins ? cast_range : met ? paint_range : range_max;
  const uint tag = cast_wins ? cast_tag : met ? rest.x | is_end * SF_TAG_END : SF_NO_HIT;
  const PointRow point = point_row(due);
  const vec4 deviates = imageLoad(normals, point.noise + own);
  const float deviate = slot < 2 ? (slot == 0 ? deviates.x : deviates.y) : (slot == 2 ? deviates.z : deviates.w);
  write_point(point, own, slot, deviate, range, tag);
}
