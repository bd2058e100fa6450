#version 450
#extension GL_GOOGLE_include_directive : require
// Casts every beam of all due sensors.

#include "shaders/raycast/records.glsl"

layout(local_size_x = SF_LANES_PER_GROUP) in;
layout(constant_id = 0) const bool kMovers = true;   // there are some
layout(constant_id = 1) const bool kSinglePrecision = false;  // ranges are measured in 32 bits where these are close enough
layout(constant_id = 2) const bool kTexels = false;  // results are too large for storage buffers, which are faster
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;            // RayRow of each sensor
layout(binding = 1, r32ui) uniform readonly uimageBuffer lanes;              // Lane of each lane
layout(binding = 2, r32f) uniform readonly imageBuffer bearings;             // a lane's middle bearing [sectors]
layout(binding = 3, rgba32ui) uniform readonly uimageBuffer directions;      // BeamDirection of each beam
layout(binding = 4, rgba32ui) uniform readonly uimageBuffer lists;           // ListHead, ListEntry, ListChunk
layout(binding = 5, r32ui) uniform readonly uimageBuffer segment_ids;              // exact segment of each entry
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer mover_rows;          // MoverRow of each mover and height
layout(binding = 7, rgba32ui) uniform readonly uimageBuffer segments;        // ExactSegment of each segment
layout(binding = 8, r32ui) uniform readonly uimageBuffer models;             // what a beam reports that meets the segment
layout(binding = 9, rgba32ui) uniform writeonly uimageBuffer range_texels;   // LaneRanges of each lane
layout(binding = 10, rgba32ui) uniform writeonly uimageBuffer hit_texels;    // LaneHits of each lane
layout(binding = 11, r32ui) uniform writeonly uimageBuffer flag_texels;   // a word a lane: SF_DOUBT, SF_GRAZES
layout(binding = 12) writeonly buffer Ranges { uvec4 lane[][2]; } ranges;         // the same tables
layout(binding = 13) writeonly buffer Hits { uvec4 lane[][1]; } hits;
layout(binding = 14) writeonly buffer BeamFlags { uint lane[]; } beam_flags;

#include "shaders/lib/intersect.glsl"
#include "shaders/lib/list_search.glsl"

Beam64 exact_beam(int slot, dvec2 origin, dvec2 heading) {
  const BeamDirection bearing = load_BeamDirection(directions, slot);
  precise double x = heading.x * bearing.cos - heading.y * bearing.sin;
  precise double y = heading.y * bearing.cos + heading.x * bearing.sin;
  return Beam64(origin, dvec2(x, y));
}

uint model_of(uint row) { return row == SF_NO_HIT ? SF_NO_HIT : imageLoad(models, int(row)).x; }

void store(int lane, LaneRanges lane_ranges, LaneHits lane_hits, uint flags) {
  if (kTexels) {
    store_LaneRanges(range_texels, lane, lane_ranges);
    store_LaneHits(hit_texels, lane, lane_hits);
    imageStore(flag_texels, lane, uvec4(flags));
  } else {
    ranges.lane[lane] = encode_LaneRanges(lane_ranges);
    hits.lane[lane] = encode_LaneHits(lane_hits);
    beam_flags.lane[lane] = flags;
  }
}

void main() {
  const int lane = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  const Lane due = load_Lane(lanes, lane);
  const RayRow row = load_RayRow(rows, int(due.row));
  const vec2 offset = vec2(row.offset_x, row.offset_y);
  const dvec2 origin = dvec2(row.origin_x, row.origin_y);
  const dvec2 heading = dvec2(row.heading_cos64, row.heading_sin64);
  const double range_max = row.range_max;
  const int lane_beams = int(row.beams + due.lane);
  Beam64 beams[SF_BEAMS_PER_LANE];
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) beams[i] = exact_beam(SF_BEAMS_PER_LANE * lane_beams + i, origin, heading);

  // Search in 32 bits. At first the end of the range is the nearest.
  const int sector = int(floor(row.heading_sectors + imageLoad(bearings, lane_beams).x)) & (SF_SECTORS - 1);
  const ListHead walls = load_ListHead(lists, int(row.walls) + sector);
  const ListHead movers = decode_ListHead(kMovers ? imageLoad(lists, int(row.movers) + sector) : uvec4(0u));
  const float farthest = 1.0 / float(range_max);
  Search s;
  s.dx = vec4(dvec4(beams[0].direction.x, beams[1].direction.x, beams[2].direction.x, beams[3].direction.x));
  s.dy = vec4(dvec4(beams[0].direction.y, beams[1].direction.y, beams[2].direction.y, beams[3].direction.y));
  s.most = vec4(farthest * (1.0 + 1e-6));
  s.low = vec4(farthest * (1.0 - 1e-6));
  s.others = vec4(0.0);
  s.entry = ivec4(-1);
  s.first_row = ivec4(0);
  search_lists(walls, movers, offset, origin, row.band, s);

  ClosestHit closest[SF_BEAMS_PER_LANE];
  uint pending = 0u;  // uncertain beams
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    pending |= s.low[i] > s.others[i] ? 0u : 1u << i;
    const uint id = s.entry[i] < 0 ? SF_NO_HIT : imageLoad(segment_ids, max(s.entry[i], 0)).x + uint(s.first_row[i]);
    closest[i] = ClosestHit(exact_range(id, beams[i], range_max), id, vec3(0.0));
  }
  uint flags = SF_UNCERTAIN * pending;

  // A beam in doubt meets every entry that is not farther than what 64 bits have found; one beam after another.
  int at = int(walls.first);
  int facing_end = at + int(walls.count);
  int end = facing_end + int(walls.back_facing);
  int k = 0;
  bool movers_left = kMovers;
  ClosestHit found = ClosestHit(range_max, SF_NO_HIT, vec3(0.0));
  while (pending != 0u) {
    const int now = findLSB(pending);
    const dvec2 direction = now < 2 ? (now == 0 ? beams[0].direction : beams[1].direction)
                                    : (now == 2 ? beams[2].direction : beams[3].direction);
    const Chunk chunk = chunk_of(at < end ? imageLoad(lists, at) : uvec4(0u), offset, int(walls.base), origin);
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
    const uint next = beam_done ? walls.first : movers.first;
    const uint next_facing = next + (beam_done ? walls.count : movers.count);
    at = list_done ? int(next) : at;
    facing_end = list_done ? int(next_facing) : facing_end;
    end = list_done ? int(next_facing + (beam_done ? walls.back_facing : movers.back_facing)) : end;
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
    closest[i].range = max(closest[i].range, row.range_min);
  }
  store(int(row.results + due.lane),
        LaneRanges(dvec4(closest[0].range, closest[1].range, closest[2].range, closest[3].range)),
        LaneHits(uvec4(model_of(closest[0].id), model_of(closest[1].id), model_of(closest[2].id), model_of(closest[3].id))),
        flags);
}
