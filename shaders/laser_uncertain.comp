#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_vote : require
// Casts the lanes that laser.comp listed in 64 bits.

#include "shaders/raycast/records.glsl"

layout(local_size_x = SF_LANES_PER_GROUP) in;  // raycast/records.h
#include "shaders/lib/laser_lane.glsl"
#include "shaders/lib/list_search.glsl"

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

// Intersects `pending` beams with every entry up to the range found so far, in 64 bits, beam by beam. Returns the beams
// that graze. One loop for walls and movers, as in search_lists.
uint decide(uint pending, RayRow row, Beam64 beams[SF_BEAMS_PER_LANE], ListHead walls, ListHead movers,
            inout ClosestHit closest[SF_BEAMS_PER_LANE]) {
  const ClosestHit nothing = ClosestHit(row.range_max, SF_NO_HIT, vec3(0.0));
  uint grazing = 0u;
  ListCursor c = begin_list(walls);
  bool movers_left = kMovers;
  ClosestHit found = nothing;
  while (pending != 0u) {
    const int now = findLSB(pending);
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
    pending = beam_done ? pending & (pending - 1u) : pending;
  }
  return grazing;
}

void main() {
  const int slot = invocation();
  const bool listed = uint(slot) < uncertain.count;
  const uvec2 entry = uncertain.lanes[listed ? slot : 0];
  const Lane due = load_Lane(lanes, int(entry.x));
  const RayRow row = load_RayRow(rows, int(due.row));
  const int first_beam = int(row.beams + due.lane);
  const Beam64 beams[SF_BEAMS_PER_LANE] = beams_of(row, first_beam);
  const int sector = int(floor(row.heading_sectors + imageLoad(bearings, first_beam).x)) & (SF_SECTORS - 1);
  const ListHead walls = load_ListHead(lists, int(row.walls) + sector);
  const ListHead movers = decode_ListHead(kMovers ? imageLoad(lists, int(row.movers) + sector) : uvec4(0u));

  ClosestHit closest[SF_BEAMS_PER_LANE];
  const uint grazing = decide(listed ? 15u : 0u, row, beams, walls, movers, closest);
  if (listed) {
    store(int(row.results + due.lane), row, beams, closest);
    uncertain.lanes[slot].y = entry.y | grazing & entry.y / SF_UNCERTAIN;
  }
}
