#version 450
#extension GL_GOOGLE_include_directive : require
// Updates occupancy maps with log odds: log odds per cell, and the states derived from them (maps/grid_update.h).

#include "maps/grid.h"
#include "shaders/sensors/occupancy_records.glsl"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;   // MapRow of each map
layout(binding = 1, r32ui) uniform readonly uimageBuffer blocks;    // MapBlock of eight lanes
layout(binding = 2, r32ui) uniform readonly uimageBuffer strips;    // written by occupancy_strips.comp
layout(binding = 3, r32ui) uniform readonly uimageBuffer hit_words;    // one word per lane: bit 2 k is set if a beam
                                                                       // ended in cell k
layout(binding = 4, r32ui) uniform writeonly uimageBuffer words;    // of all maps; the last word is for lanes without
                                                                    // work
layout(binding = 5, rgba32ui) uniform uimageBuffer odds;            // SF_ODDS_TEXELS per word

#include "shaders/lib/cover.glsl"

struct Weighed {
  uint pair;    // two log odds
  uint states;  // bits 0 and 1 of the first cell, 2 and 3 of the second
};

uint state_of(int odds_of_cell) {
  return odds_of_cell > 0 ? SF_CELL_OCCUPIED : odds_of_cell < 0 ? SF_CELL_FREE : SF_CELL_UNEXPLORED;
}

// `freed` and `occupied` have bit 0 for the first cell, bit 2 for the second.
Weighed weigh(uint pair, uint freed, uint occupied, ivec3 rule) {
  const ivec2 old = ivec2(bitfieldExtract(int(pair), 0, 16), bitfieldExtract(int(pair), 16, 16));
  const ivec2 up = ivec2(int(occupied) & 1, int(occupied >> 2) & 1);
  const ivec2 down = ivec2(int(freed) & 1, int(freed >> 2) & 1) * (1 - up);
  const ivec2 now = clamp(old + up * rule.x - down * rule.y, ivec2(-rule.z), ivec2(rule.z));
  return Weighed((uint(now.x) & 0xFFFFu) | uint(now.y) << 16, state_of(now.x) | state_of(now.y) << 2);
}

void main() {
  const int lane = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const MapBlock block = load_MapBlock(blocks, lane / SF_MAP_BLOCK);
  const MapRow map = load_MapRow(rows, int(block.row));
  const WordUpdate share = cover_word(lane, block, map);
  const ivec3 rule = ivec3(map.hit, map.miss, map.limit);
  const int word = share.word < 0 ? imageSize(words) - 1 : share.word;
  uint states = 0u;
  for (int half_word = 0; half_word < SF_ODDS_TEXELS; ++half_word) {
    const uvec4 old = imageLoad(odds, SF_ODDS_TEXELS * word + half_word);
    uvec4 now = old;
    for (int k = 0; k < 4; ++k) {
      const int cell = 8 * half_word + 2 * k;
      const Weighed pair = weigh(old[k], share.freed >> (2 * cell), share.occupied >> (2 * cell), rule);
      now[k] = pair.pair;
      states |= pair.states << (2 * cell);
    }
    imageStore(odds, SF_ODDS_TEXELS * word + half_word, now);
  }
  imageStore(words, word, uvec4(states));
}
