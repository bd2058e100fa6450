#version 450
#extension GL_GOOGLE_include_directive : require
// Casts every beam of all due sensors.

#include "shaders/raycast/records.glsl"

layout(local_size_x = SF_LANES_PER_GROUP) in;  // raycast/records.h
layout(constant_id = 0) const bool kMovers = true;   // the world has movers
layout(constant_id = 1) const bool kSinglePrecision = false;  // ranges in 32 bits where these are accurate enough
layout(constant_id = 2) const bool kTexels = false;  // results exceed the limit of storage buffers, which are faster
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;            // RayRow of each sensor
layout(binding = 1, r32ui) uniform readonly uimageBuffer lanes;              // Lane of each lane
layout(binding = 2, r32f) uniform readonly imageBuffer bearings;             // middle bearing of each lane [sectors]
layout(binding = 3, rgba32ui) uniform readonly uimageBuffer directions;      // BeamDirection of each beam
layout(binding = 4, rgba32ui) uniform readonly uimageBuffer lists;           // ListHead, ListEntry, ListChunk
layout(binding = 5, r32ui) uniform readonly uimageBuffer segment_ids;              // exact segment of each entry
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer mover_rows;          // MoverRow of each mover and height
layout(binding = 7, rgba32ui) uniform readonly uimageBuffer segments;        // ExactSegment of each segment
layout(binding = 8, r32ui) uniform readonly uimageBuffer models;             // `Segment::model` of each segment
layout(binding = 9, rgba32ui) uniform writeonly uimageBuffer range_texels;   // LaneRanges of each lane
layout(binding = 10, rgba32ui) uniform writeonly uimageBuffer hit_texels;    // LaneHits of each lane
layout(binding = 11, r32ui) uniform writeonly uimageBuffer flag_texels;   // one word per lane: SF_UNCERTAIN, SF_GRAZING
layout(binding = 12) writeonly buffer Ranges { uvec4 lane[][2]; } ranges;         // the same tables
layout(binding = 13) writeonly buffer Hits { uvec4 lane[][1]; } hits;
layout(binding = 14) writeonly buffer BeamFlags { uint lane[]; } beam_flags;

#include "shaders/lib/intersect.glsl"
#include "shaders/lib/list_search.glsl"

// Directions in the world of the lane whose beams begin at `first` in the tables.
Beam64[SF_BEAMS_PER_LANE] beams_of(RayRow row, int first) {
  Beam64 beams[SF_BEAMS_PER_LANE];
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    const BeamDirection bearing = load_BeamDirection(directions, SF_BEAMS_PER_LANE * first + i);
    precise double x = row.heading_cos64 * bearing.cos - row.heading_sin64 * bearing.sin;
    precise double y = row.heading_sin64 * bearing.cos + row.heading_cos64 * bearing.sin;
    beams[i] = Beam64(dvec2(row.origin_x, row.origin_y), dvec2(x, y));
  }
  return beams;
}

// Initially the end of the range is the nearest.
Search begin_search(Beam64 beams[SF_BEAMS_PER_LANE], double range_max) {
  const float farthest = 1.0 / float(range_max);
  Search s;
  s.dx = vec4(dvec4(beams[0].direction.x, beams[1].direction.x, beams[2].direction.x, beams[3].direction.x));
  s.dy = vec4(dvec4(beams[0].direction.y, beams[1].direction.y, beams[2].direction.y, beams[3].direction.y));
  s.most = vec4(farthest * (1.0 + 1e-6));
  s.low = vec4(farthest * (1.0 - 1e-6));
  s.others = vec4(0.0);
  s.entry = ivec4(-1);
  s.first_row = ivec4(0);
  return s;
}

// Evaluates the nearest segments in 64 bits. Returns the uncertain beams, a bit each.
uint measure(Search s, Beam64 beams[SF_BEAMS_PER_LANE], double range_max, out ClosestHit closest[SF_BEAMS_PER_LANE]) {
  uint uncertain = 0u;
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    uncertain |= s.low[i] > s.others[i] ? 0u : 1u << i;
    const uint id = s.entry[i] < 0 ? SF_NO_HIT : imageLoad(segment_ids, max(s.entry[i], 0)).x + uint(s.first_row[i]);
    closest[i] = ClosestHit(exact_range(id, beams[i], range_max), id, vec3(0.0));
  }
  return uncertain;
}

// Position in a list: the next entry of a chunk.
struct ListCursor {
  int at, facing_end, end;  // chunks
  int k;
};

ListCursor begin_list(ListHead list) {
  const int facing_end = int(list.first + list.count);
  return ListCursor(int(list.first), facing_end, facing_end + int(list.back_facing), 0);
}

// Advances to the next entry; where the rest of this part of the list is too far, to the next part.
void advance(inout ListCursor c, bool far) {
  ++c.k;
  const bool chunk_done = far || c.k == SF_CHUNK;
  c.at = far ? (c.at < c.facing_end ? c.facing_end : c.end) : chunk_done ? c.at + 1 : c.at;
  c.k = chunk_done ? 0 : c.k;
}

// The segment of the entry at `c`; SF_NO_HIT and `far` where it and its successors lie beyond `range`.
uint entry_at(ListCursor c, RayRow row, int base, double range, out bool far) {
  const dvec2 origin = dvec2(row.origin_x, row.origin_y);
  const Chunk chunk = chunk_of(c.at < c.end ? imageLoad(lists, c.at) : uvec4(0u), vec2(row.offset_x, row.offset_y), base, origin);
  far = c.at >= c.end || double(chunk.nearest) > range;
  const int entry = c.k < 2 ? (c.k == 0 ? chunk.entries.x : chunk.entries.y) : (c.k == 2 ? chunk.entries.z : chunk.entries.w);
  const uint name = far ? SF_NO_HIT : imageLoad(segment_ids, entry).x;
  return name == SF_NO_HIT ? SF_NO_HIT : name + uint(chunk.first_row);
}

// Intersects uncertain beams with every entry up to the range found so far, in 64 bits, beam by beam. Returns the beams
// that graze. One loop for walls and movers, as in search_lists.
uint decide(uint uncertain, RayRow row, Beam64 beams[SF_BEAMS_PER_LANE], ListHead walls, ListHead movers,
            inout ClosestHit closest[SF_BEAMS_PER_LANE]) {
  const ClosestHit nothing = ClosestHit(row.range_max, SF_NO_HIT, vec3(0.0));
  uint grazing = 0u;
  ListCursor c = begin_list(walls);
  bool movers_left = kMovers;
  ClosestHit found = nothing;
  while (uncertain != 0u) {
    const int now = findLSB(uncertain);
    const dvec2 direction = now < 2 ? (now == 0 ? beams[0].direction : beams[1].direction)
                                    : (now == 2 ? beams[2].direction : beams[3].direction);
    bool far;
    const uint id = entry_at(c, row, int(walls.base), found.range, far);
    intersect(id, Beam64(beams[0].origin, direction), found);
    advance(c, far);
    const bool list_done = c.at >= c.end;
    const bool beam_done = list_done && !movers_left;
    const ListCursor at_walls = begin_list(walls), at_movers = begin_list(movers);
    c.at = list_done ? (beam_done ? at_walls.at : at_movers.at) : c.at;
    c.facing_end = list_done ? (beam_done ? at_walls.facing_end : at_movers.facing_end) : c.facing_end;
    c.end = list_done ? (beam_done ? at_walls.end : at_movers.end) : c.end;
    movers_left = list_done ? beam_done && kMovers : movers_left;
    grazing |= beam_done && grazes(found, float(SF_MIN_SINE)) ? SF_GRAZING << now : 0u;
    for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
      const bool mine = beam_done && now == i;
      closest[i].range = mine ? found.range : closest[i].range;
      closest[i].id = mine ? found.id : closest[i].id;
    }
    found.range = beam_done ? nothing.range : found.range;
    found.id = beam_done ? nothing.id : found.id;
    uncertain = beam_done ? uncertain & (uncertain - 1u) : uncertain;
  }
  return grazing;
}

// The reported range, within the sensor's limits.
double reported_range(ClosestHit hit, Beam64 beam, RayRow row) {
  double range = hit.range;
  if (kSinglePrecision) {
    const float t = range_single(hit.id, beam, float(row.range_max));
    range = t >= 0.0 ? min(double(t), row.range_max) : range;
  }
  return max(range, row.range_min);
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
  const int first_beam = int(row.beams + due.lane);
  const Beam64 beams[SF_BEAMS_PER_LANE] = beams_of(row, first_beam);
  const int sector = int(floor(row.heading_sectors + imageLoad(bearings, first_beam).x)) & (SF_SECTORS - 1);
  const ListHead walls = load_ListHead(lists, int(row.walls) + sector);
  const ListHead movers = decode_ListHead(kMovers ? imageLoad(lists, int(row.movers) + sector) : uvec4(0u));

  Search s = begin_search(beams, row.range_max);
  search_lists(walls, movers, vec2(row.offset_x, row.offset_y), dvec2(row.origin_x, row.origin_y), row.band, s);
  ClosestHit closest[SF_BEAMS_PER_LANE];
  const uint uncertain = measure(s, beams, row.range_max, closest);
  const uint grazing = decide(uncertain, row, beams, walls, movers, closest);

  LaneRanges lane_ranges;
  LaneHits lane_hits;
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    lane_ranges.range[i] = reported_range(closest[i], beams[i], row);
    lane_hits.model[i] = model_of(closest[i].id);
  }
  store(int(row.results + due.lane), lane_ranges, lane_hits, SF_UNCERTAIN * uncertain | grazing);
}
