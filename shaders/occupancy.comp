#version 450
#extension GL_GOOGLE_include_directive : require
// Updates occupancy maps: one scan per map, word by word. No two lanes write the same word.

#include "maps/grid.h"
#include "shaders/sensors/occupancy_records.glsl"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;   // MapRow of each map
layout(binding = 1, r32ui) uniform readonly uimageBuffer blocks;    // MapBlock of eight lanes
layout(binding = 2, r32ui) uniform readonly uimageBuffer strips;    // written by occupancy_strips.comp
layout(binding = 3, r32ui) uniform readonly uimageBuffer hit_words;    // one word per lane: bit 2 k is set if a beam
                                                                       // ended in cell k
layout(binding = 4, r32ui) uniform uimageBuffer words;              // of all maps; the last word is for lanes without
                                                                    // work

#include "shaders/lib/cover.glsl"

void main() {
  const int lane = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const MapBlock block = load_MapBlock(blocks, lane / SF_MAP_BLOCK);
  const MapRow map = load_MapRow(rows, int(block.row));
  const WordUpdate share = cover_word(lane, block, map);
  const int word = share.word < 0 ? imageSize(words) - 1 : share.word;
  const uint old = imageLoad(words, word).x;
  const uint covered = share.freed | share.occupied;
  const uint states = SF_CELL_OCCUPIED * share.occupied | SF_CELL_FREE * (share.freed & ~share.occupied);
  imageStore(words, word, uvec4((old & ~(3u * covered)) | states));
}
