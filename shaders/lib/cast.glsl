// Casting every beam of every sensor that is due: the whole kernel. With SF_SINGLE, ranges are measured in 32 bits where these are close
// enough.

#include "raycast/records.h"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;        // SF_ROW_TEXELS a sensor: RayRow
layout(binding = 1, r32ui) uniform readonly uimageBuffer lanes;          // two words a lane: Lane
layout(binding = 2, rgba32f) uniform readonly imageBuffer directions;    // two texels a lane: four cosines, four sines
layout(binding = 3, r32f) uniform readonly imageBuffer bearings;         // a lane's middle bearing [sectors]
layout(binding = 4, rgba32ui) uniform readonly uimageBuffer directions64;  // a texel a beam: cosine, sine
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer headers;     // ListHeader
layout(binding = 6, rgba32f) uniform readonly imageBuffer entries;       // ListEntry
layout(binding = 7, r32ui) uniform readonly uimageBuffer ids;            // exact segment of each entry, and its clearance
layout(binding = 8, r32f) uniform readonly imageBuffer nearest;          // [m] least distance of each chunk
layout(binding = 9, rgba32ui) uniform readonly uimageBuffer segments;    // two texels a segment: ExactSegment
layout(binding = 10, r32ui) uniform readonly uimageBuffer models;        // what a beam reports that meets the segment
layout(binding = 11, rgba32ui) uniform writeonly uimageBuffer ranges;    // two texels a lane: four doubles [m]
layout(binding = 12, rgba32ui) uniform writeonly uimageBuffer hits;      // a texel a lane: four models
layout(binding = 13, r32ui) uniform writeonly uimageBuffer doubts;       // a word a lane: SF_DOUBT, SF_GRAZES

#include "shaders/lib/decide.glsl"
#include "shaders/lib/rays.glsl"

Beam64 exact_beam(int slot, dvec2 origin, dvec2 heading) {
  const uvec4 words = imageLoad(directions64, slot);
  const double c = packDouble2x32(words.xy);
  const double s = packDouble2x32(words.zw);
  precise double x = heading.x * c - heading.y * s;
  precise double y = heading.y * c + heading.x * s;
  return Beam64(origin, dvec2(x, y));
}

uint model_of(uint id) { return id == SF_NO_HIT ? SF_NO_HIT : imageLoad(models, int(id)).x; }

void main() {
  const int lane = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const int row = SF_ROW_TEXELS * int(imageLoad(lanes, 2 * lane).x);
  const int own = int(imageLoad(lanes, 2 * lane + 1).x);

  const vec4 place = uintBitsToFloat(imageLoad(rows, row));
  const vec4 look = uintBitsToFloat(imageLoad(rows, row + 1));
  const uvec4 tables = imageLoad(rows, row + 2);
  const uvec4 heading_words = imageLoad(rows, row + 4);
  const dvec2 heading = dvec2(packDouble2x32(heading_words.xy), packDouble2x32(heading_words.zw));
  const vec2 turn = vec2(heading);
  const float band = look.y;
  const int lane_beams = int(tables.z) + own;

  // Search in 32 bits: walls, then movers.
  const vec4 bc = imageLoad(directions, 2 * lane_beams);
  const vec4 bs = imageLoad(directions, 2 * lane_beams + 1);
  const Beams d = Beams(turn.x * bc - turn.y * bs, turn.y * bc + turn.x * bs);
  const int sector = int(floor(look.x + imageLoad(bearings, lane_beams).x)) & (SF_SECTORS - 1);
  const uvec4 walls = imageLoad(headers, int(tables.x) + sector);
  const uvec4 movers = imageLoad(headers, int(tables.y) + sector);
  Nearest best = Nearest(vec4(look.z), vec4(1.0), ivec4(-1), false);
  search_lists(walls, movers, place, d, band, best);

  // Prove each winner, or look at all in 64 bits.
  const float movers_to_walls = uintBitsToFloat(movers.z);
  bool sure[SF_BEAMS_PER_LANE];
  uint winner[SF_BEAMS_PER_LANE];
  uint open = 0u;  // beams in doubt
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    const bool is_wall = uint(best.entry[i]) - SF_CHUNK * walls.x < SF_CHUNK * walls.y;
    const vec2 o = is_wall ? place.xy : place.zw;
    winner[i] = imageLoad(ids, max(best.entry[i], 0)).x;
    const Proof proof = prove(best.entry[i], winner[i], o, vec2(d.dx[i], d.dy[i]), band,
                              is_wall ? movers_to_walls : 1e30, best.below[i]);
    sure[i] = proof.holds && !best.edge_on;
    open |= sure[i] ? 0u : 1u << i;
  }
  uint verdict = SF_DOUBT * open;

  const uvec4 origin_words = imageLoad(rows, row + 3);
  const uvec4 range_words = imageLoad(rows, row + 5);
  const dvec2 origin = dvec2(packDouble2x32(origin_words.xy), packDouble2x32(origin_words.zw));
  const double range_max = packDouble2x32(range_words.xy);
  Beam64 beams[SF_BEAMS_PER_LANE];
  Decision decisions[SF_BEAMS_PER_LANE];
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    beams[i] = exact_beam(SF_BEAMS_PER_LANE * lane_beams + i, origin, heading);
    decisions[i] = Decision(range_max, SF_NO_HIT, vec3(0.0));
    const uint word = best.entry[i] < 0 || !sure[i] ? SF_NO_HIT : winner[i];
    decide(word, beams[i], decisions[i]);
  }

  // A beam in doubt meets every entry, those that face it until they are farther than what 64 bits have found; one beam after another.
  int chunk = int(walls.x);
  int facing_end = chunk + int(walls.y);
  int end = facing_end + int(walls.w);
  int k = 0;
  bool movers_left = true;
  Decision found = Decision(range_max, SF_NO_HIT, vec3(0.0));
  while (open != 0u) {
    const int now = findLSB(open);
    const dvec2 direction = now < 2 ? (now == 0 ? beams[0].direction : beams[1].direction)
                                    : (now == 2 ? beams[2].direction : beams[3].direction);
    decide(chunk < end ? imageLoad(ids, SF_CHUNK * chunk + k).x : SF_NO_HIT, Beam64(origin, direction), found);
    k = k + 1;
    chunk = k == SF_CHUNK ? chunk + 1 : chunk;
    k = k == SF_CHUNK ? 0 : k;
    const bool far = chunk < facing_end && double(imageLoad(nearest, chunk).x) > found.range;
    chunk = far ? facing_end : chunk;
    const bool list_done = chunk >= end;
    const bool beam_done = list_done && !movers_left;
    const uvec4 next = beam_done ? walls : movers;
    chunk = list_done ? int(next.x) : chunk;
    facing_end = list_done ? int(next.x + next.y) : facing_end;
    end = list_done ? int(next.x + next.y + next.w) : end;
    k = list_done || far ? 0 : k;
    movers_left = list_done ? beam_done : movers_left;
    verdict |= beam_done && grazes(found, look.w) ? SF_GRAZES << now : 0u;
    for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
      const bool mine = beam_done && now == i;
      decisions[i].range = mine ? found.range : decisions[i].range;
      decisions[i].id = mine ? found.id : decisions[i].id;
    }
    found.range = beam_done ? range_max : found.range;
    found.id = beam_done ? SF_NO_HIT : found.id;
    open = beam_done ? open & (open - 1u) : open;
  }

#ifdef SF_SINGLE
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    const float t = measure_single(decisions[i].id, beams[i], float(range_max));
    decisions[i].range = t >= 0.0 ? min(double(t), range_max) : decisions[i].range;
  }
#endif

  const double range_min = packDouble2x32(range_words.zw);
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) decisions[i].range = max(decisions[i].range, range_min);
  const int out_lane = int(tables.w) + own;
  imageStore(ranges, 2 * out_lane, uvec4(unpackDouble2x32(decisions[0].range), unpackDouble2x32(decisions[1].range)));
  imageStore(ranges, 2 * out_lane + 1, uvec4(unpackDouble2x32(decisions[2].range), unpackDouble2x32(decisions[3].range)));
  imageStore(hits, out_lane,
             uvec4(model_of(decisions[0].id), model_of(decisions[1].id), model_of(decisions[2].id), model_of(decisions[3].id)));
  imageStore(doubts, out_lane, uvec4(verdict));
}
