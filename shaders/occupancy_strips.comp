#version 450
#extension GL_GOOGLE_include_directive : require
// Finds the cells of a strip that are covered by the lines of a scan's beams, exactly, by the rule of
// maps/grid_update.h.
//
// A strip is 32 cells of one column (flat lines cross it in one cell each) or of one row (steep lines). At step i, a
// line to an end n cells along and a to the side is floor(i a / n + 1/2) cells to the side. That sum is a multiple of 1
// / (2 n). A bias that exceeds 0 by more than rounding, and stays below 1 / (2 n) by more than rounding, gives the same
// floor: with n <= 1023, the rounding errors of the slope and of the product are below 1.3e-4 together, and 1 / (2 n)
// is above 4.8e-4.

#include "shaders/sensors/occupancy_records.glsl"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;     // MapRow of each scan
layout(binding = 1, r32ui) uniform readonly uimageBuffer blocks;      // MapBlock of eight lanes
layout(binding = 2, rgba32f) uniform readonly imageBuffer lines;      // one texel per two beams: slope, reach; slope, reach (BeamLine)
layout(binding = 3, r32ui) uniform writeonly uimageBuffer strips;     // one word per lane: bit k for its k-th cell

#include "shaders/lib/candidates.glsl"

void main() {
  const int lane = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const MapBlock block = load_MapBlock(blocks, lane / SF_MAP_BLOCK);
  const bool flat_strip = (block.row & SF_STEEP) == 0u;
  const MapRow map = load_MapRow(rows, int(block.row & ~SF_STEEP));

  // The strip relative to the sensor's cell: `offset` along the lines, cells [side, side + 32) across.
  const int at = int(block.place & 0xFFFFu) + lane % SF_MAP_BLOCK;
  const int across = SF_STRIP * int(block.place >> 16);
  const int offset = at - (flat_strip ? map.column : map.row);
  const int side = across - (flat_strip ? map.row : map.column);
  const bool back = offset < 0;
  const int i = abs(offset);
  const int low = max(side, -i);  // no line is farther to the side than along
  const int high = min(side + SF_STRIP - 1, i);

  // The centre of a covered cell lies within half a cell along and one cell across from the beam itself: half a cell
  // for the end's cell, half a cell for rounding.
  const vec2 within = flat_strip ? vec2(map.within_x, map.within_y) : vec2(map.within_y, map.within_x);
  const float along = float(i) - (back ? -within.x : within.x);
  const float y_low = float(low) - 1.01 - within.y;
  const float y_high = float(high) + 1.01 - within.y;
  const float a_low = bearing_of(vec2(along + (y_low < 0.0 ? -0.51 : 0.51), y_low));
  const float a_high = bearing_of(vec2(along + (y_high > 0.0 ? -0.51 : 0.51), y_high));
  const float axis = flat_strip ? (back ? PI : 0.0) : (back ? 0.5 * PI : -0.5 * PI);
  const bool turned = flat_strip != back;  // the strip's cells are numbered clockwise
  const float middle = axis + (turned ? -0.5 : 0.5) * (a_low + a_high) - map.heading;
  const float bearing = middle - 2.0 * PI * round(middle * (0.5 / PI));
  const int pairs = int(map.pairs);
  const Candidates c = candidates(bearing, 0.5 * (a_high - a_low), i <= 1, map);

  const int first_pair = int(map.lines);
  const float nearest = float(i) + (flat_strip ? 0.0 : SF_STEEP_REACH);
  const float farthest = flat_strip ? SF_STEEP_REACH : 2.0 * SF_STEEP_REACH;
  const int total = i > 0 && low <= high ? count_of(c, pairs) : 0;
  uint covered = i == 0 && flat_strip && side <= 0 && side > -SF_STRIP ? 1u << -side : 0u;  // the sensor's own cell
  int j = 0;
  while (j < total) {
    const vec4 two = imageLoad(lines, first_pair + candidate(c, j));
    const vec2 slope = back ? -two.xz : two.xz;
    const vec2 reach = back ? -two.yw : two.yw;
    const uvec2 bias = (floatBitsToUint(slope) & 0x80000000u) | floatBitsToUint(0.5 + 2.44e-4);
    const uvec2 bit = uvec2(ivec2(float(i) * slope + uintBitsToFloat(bias)) - side);
    const bool first_met = reach.x >= nearest && reach.x < farthest && bit.x < uint(SF_STRIP);
    const bool second_met = reach.y >= nearest && reach.y < farthest && bit.y < uint(SF_STRIP);
    covered |= (first_met ? 1u << (bit.x & 31u) : 0u) | (second_met ? 1u << (bit.y & 31u) : 0u);
    ++j;
  }
  imageStore(strips, lane, uvec4(covered));
}
