#version 450
#extension GL_GOOGLE_include_directive : require
// Casts every beam of all due sensors.

#include "raycast/records.h"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool kMovers = true;   // the world has movers
layout(constant_id = 1) const bool kSinglePrecision = false;  // ranges in 32 bits where these are accurate enough
layout(constant_id = 2) const bool kTexels = false;  // results exceed the limit of storage buffers, which are faster
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;            // SF_ROW_TEXELS per sensor: RayRow
layout(binding = 1, r32ui) uniform readonly uimageBuffer lanes;              // two words per lane: Lane
layout(binding = 2, r32f) uniform readonly imageBuffer bearings;             // middle bearing of each lane [sectors]
layout(binding = 3, rgba32ui) uniform readonly uimageBuffer directions;      // one texel per beam: cosine, sine
layout(binding = 4, rgba32ui) uniform readonly uimageBuffer lists;           // ListHead, ListEntry, ListChunk
layout(binding = 5, r32ui) uniform readonly uimageBuffer segment_ids;              // exact segment of each entry
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer mover_rows;          // two texels per mover and height: MoverRow
layout(binding = 7, rgba32ui) uniform readonly uimageBuffer segments;        // two texels per segment: ExactSegment
layout(binding = 8, r32ui) uniform readonly uimageBuffer models;             // `Segment::model` of each segment
layout(binding = 9, rgba32ui) uniform writeonly uimageBuffer range_texels;   // two texels per lane: four doubles [m]
layout(binding = 10, rgba32ui) uniform writeonly uimageBuffer hit_texels;    // one texel per lane: four models
layout(binding = 11, r32ui) uniform writeonly uimageBuffer flag_texels;   // one word per lane: SF_UNCERTAIN, SF_GRAZING
layout(binding = 12) writeonly buffer Ranges { uvec4 ranges[]; };            // the same tables
layout(binding = 13) writeonly buffer Hits { uvec4 hits[]; };
layout(binding = 14) writeonly buffer BeamFlags { uint beam_flags[]; };

#include "shaders/lib/intersect.glsl"
#include "shaders/lib/list_search.glsl"

Beam64 exact_beam(int slot, dvec2 origin, dvec2 heading) {
  const uvec4 words = imageLoad(directions, slot);
  const double c = packDouble2x32(words.xy);
  const double s = packDouble2x32(words.zw);
  precise double x = heading.x * c - heading.y * s;
  precise double y = heading.y * c + heading.x * s;
  return Beam64(origin, dvec2(x, y));
}

uint model_of(uint row) { return row == SF_NO_HIT ? SF_NO_HIT : imageLoad(models, int(row)).x; }

void store(int lane, uvec4 two, uvec4 more, uvec4 hit_models, uint flags) {
  if (kTexels) {
    imageStore(range_texels, 2 * lane, two);
    imageStore(range_texels, 2 * lane + 1, more);
    imageStore(hit_texels, lane, hit_models);
    imageStore(flag_texels, lane, uvec4(flags));
  } else {
    ranges[2 * lane] = two;
    ranges[2 * lane + 1] = more;
    hits[lane] = hit_models;
    beam_flags[lane] = flags;
  }
}

void main() {
  const int lane = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const int row = SF_ROW_TEXELS * int(imageLoad(lanes, 2 * lane).x);
  const int own = int(imageLoad(lanes, 2 * lane + 1).x);

  const vec4 view = uintBitsToFloat(imageLoad(rows, row));
  const uvec4 tables = imageLoad(rows, row + 1);
  const uvec4 origin_words = imageLoad(rows, row + 2);
  const uvec4 heading_words = imageLoad(rows, row + 3);
  const uvec4 range_words = imageLoad(rows, row + 4);
  const dvec2 origin = dvec2(packDouble2x32(origin_words.xy), packDouble2x32(origin_words.zw));
  const dvec2 heading = dvec2(packDouble2x32(heading_words.xy), packDouble2x32(heading_words.zw));
  const double range_max = packDouble2x32(range_words.xy);
  const double range_min = packDouble2x32(range_words.zw);
  const float band = view.w;
  const int lane_beams = int(tables.z) + own;
  Beam64 beams[SF_BEAMS_PER_LANE];
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) beams[i] = exact_beam(SF_BEAMS_PER_LANE * lane_beams + i, origin, heading);

  // Search in 32 bits. Initially the end of the range is the nearest.
  const int sector = int(floor(view.z + imageLoad(bearings, lane_beams).x)) & (SF_SECTORS - 1);
  const uvec4 walls = imageLoad(lists, int(tables.x) + sector);
  const uvec4 movers = kMovers ? imageLoad(lists, int(tables.y) + sector) : uvec4(0u);
  const float farthest = 1.0 / float(range_max);
  Search s;
  s.dx = vec4(dvec4(beams[0].direction.x, beams[1].direction.x, beams[2].direction.x, beams[3].direction.x));
  s.dy = vec4(dvec4(beams[0].direction.y, beams[1].direction.y, beams[2].direction.y, beams[3].direction.y));
  s.most = vec4(farthest * (1.0 + 1e-6));
  s.low = vec4(farthest * (1.0 - 1e-6));
  s.others = vec4(0.0);
  s.entry = ivec4(-1);
  s.first_row = ivec4(0);
  search_lists(walls, movers, view.xy, origin, band, s);

  ClosestHit closest[SF_BEAMS_PER_LANE];
  uint pending = 0u;  // uncertain beams
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    pending |= s.low[i] > s.others[i] ? 0u : 1u << i;
    const uint id = s.entry[i] < 0 ? SF_NO_HIT : imageLoad(segment_ids, max(s.entry[i], 0)).x + uint(s.first_row[i]);
    closest[i] = ClosestHit(exact_range(id, beams[i], range_max), id, vec3(0.0));
  }
  uint flags = SF_UNCERTAIN * pending;

  // An uncertain beam is intersected with every entry up to the range found so far in 64 bits, beam by beam.
  int at = int(walls.x);
  int facing_end = at + int(walls.y);
  int end = facing_end + int(walls.z);
  int k = 0;
  bool movers_left = kMovers;
  ClosestHit found = ClosestHit(range_max, SF_NO_HIT, vec3(0.0));
  while (pending != 0u) {
    const int now = findLSB(pending);
    const dvec2 direction = now < 2 ? (now == 0 ? beams[0].direction : beams[1].direction)
                                    : (now == 2 ? beams[2].direction : beams[3].direction);
    const Chunk chunk = chunk_of(at < end ? imageLoad(lists, at) : uvec4(0u), view.xy, int(walls.w), origin);
    const bool far = at >= end || double(chunk.nearest) > found.range;
    const int entry = k < 2 ? (k == 0 ? chunk.entries.x : chunk.entries.y) : (k == 2 ? chunk.entries.z : chunk.entries.w);
    const uint name = far ? SF_NO_HIT : imageLoad(segment_ids, entry).x;
    intersect(name == SF_NO_HIT ? SF_NO_HIT : name + uint(chunk.first_row), Beam64(origin, direction), found);
    ++k;
    const bool chunk_done = far || k == SF_CHUNK;
    at = far ? (at < facing_end ? facing_end : end) : chunk_done ? at + 1 : at;
    k = chunk_done ? 0 : k;
    const bool list_done = at >= end;
    const bool beam_done = list_done && !movers_left;
    const uvec4 next = beam_done ? walls : movers;
    at = list_done ? int(next.x) : at;
    facing_end = list_done ? int(next.x + next.y) : facing_end;
    end = list_done ? int(next.x + next.y + next.z) : end;
    movers_left = list_done ? beam_done && kMovers : movers_left;
    flags |= beam_done && grazes(found, float(SF_MIN_SINE)) ? SF_GRAZING << now : 0u;
    for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
      const bool mine = beam_done && now == i;
      closest[i].range = mine ? found.range : closest[i].range;
      closest[i].id = mine ? found.id : closest[i].id;
    }
    found.range = beam_done ? range_max : found.range;
    found.id = beam_done ? SF_NO_HIT : found.id;
    pending = beam_done ? pending & (pending - 1u) : pending;
  }

  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    if (kSinglePrecision) {
      const float t = range_single(closest[i].id, beams[i], float(range_max));
      closest[i].range = t >= 0.0 ? min(double(t), range_max) : closest[i].range;
    }
    closest[i].range = max(closest[i].range, range_min);
  }
  store(int(tables.w) + own, uvec4(unpackDouble2x32(closest[0].range), unpackDouble2x32(closest[1].range)),
        uvec4(unpackDouble2x32(closest[2].range), unpackDouble2x32(closest[3].range)),
        uvec4(model_of(closest[0].id), model_of(closest[1].id), model_of(closest[2].id), model_of(closest[3].id)),
        flags);
}
