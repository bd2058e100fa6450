#version 450
#extension GL_GOOGLE_include_directive : require
// Casts the uncertain beams of the lanes listed by laser.comp in 64 bits, with one invocation for each beam of a lane.

#include "shaders/raycast/records.glsl"

layout(local_size_x = SF_LANES_PER_GROUP) in;  // raycast/records.h
#include "shaders/lib/laser_lane.glsl"
#include "shaders/lib/list_chunk.glsl"

// Position in a list, and the ends of its front-facing and back-facing parts [chunks].
struct ListCursor {
  int at, facing_end, end;
};

ListCursor begin_list(ListHead list) {
  const int facing_end = int(list.first + list.count);
  return ListCursor(int(list.first), facing_end, facing_end + int(list.back_facing));
}

// Advances to the next chunk, or to the next part of the list if the rest of this part is too far away.
void advance(inout ListCursor c, bool far) { c.at = far ? (c.at < c.facing_end ? c.facing_end : c.end) : c.at + 1; }

// Finds the nearest segment of all entries in 64 bits. Walls and movers share one loop, as in search_lists.
// @param live false: searches nothing
ClosestHit decide(bool live, ScanLane scan, Beam64 beam) {
  ClosestHit found = ClosestHit(scan.row.range_max, SF_NO_HIT, vec3(0.0));
  ListCursor c = begin_list(scan.walls);
  bool movers_left = kMovers;
  while (live) {
    const bool inside = c.at < c.end;
    const Chunk chunk = chunk_of(inside ? imageLoad(lists, c.at) : uvec4(0u), vec2(scan.row.offset_x, scan.row.offset_y),
                                 int(scan.walls.base), beam.origin);
    const bool far = !inside || double(chunk.nearest) > found.range;
    for (int k = 0; k < SF_CHUNK; ++k) {
      const uint name = imageLoad(segment_ids, chunk.entries[k]).x;
      intersect(far || name == SF_NO_HIT ? SF_NO_HIT : name + uint(chunk.first_row), beam, found);
    }
    advance(c, far);
    const bool list_done = c.at >= c.end;
    live = !list_done || movers_left;
    const ListCursor at_movers = begin_list(scan.movers);
    c.at = list_done ? at_movers.at : c.at;
    c.facing_end = list_done ? at_movers.facing_end : c.facing_end;
    c.end = list_done ? at_movers.end : c.end;
    movers_left = movers_left && !list_done;
  }
  return found;
}

// Two beams share a texel of results, so one invocation stores all results of a lane.
void decide_lane(bool live, ScanLane scan, uint slot, uint asked) {
  ClosestHit closest[SF_BEAMS_PER_LANE];
  uint grazing = 0u;
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    closest[i] = decide(live, scan, scan.beams[i]);
    grazing |= grazes(closest[i], float(SF_MIN_SINE)) ? SF_GRAZING << i : 0u;
  }
  if (!live) return;
  store(scan, closest);
  uncertain.lanes[slot].y |= grazing & asked;
}

void decide_beam(bool live, ScanLane scan, uint slot, int i) {
  const Beam64 beam = i < 2 ? (i == 0 ? scan.beams[0] : scan.beams[1]) : (i == 2 ? scan.beams[2] : scan.beams[3]);
  const ClosestHit hit = decide(live, scan, beam);
  if (!live) return;
  ranges.lane[scan.results][i] = reported_range(hit, beam, scan.row);
  hits.lane[scan.results][i] = reported_model(hit, scan.row);
  if (grazes(hit, float(SF_MIN_SINE))) atomicOr(uncertain.lanes[slot].y, SF_GRAZING << i);
}

void main() {
  const uint slot = uint(invocation()) / SF_BEAMS_PER_LANE;
  const int own = invocation() % SF_BEAMS_PER_LANE;
  const bool listed = slot < uncertain.count;
  const uvec2 entry = uncertain.lanes[listed ? slot : 0u];
  const ScanLane scan = scan_lane(int(entry.x));
  const uint asked = entry.y / SF_UNCERTAIN;
  if (kTexels) {
    decide_lane(listed && own == 0, scan, slot, asked);
  } else {
    decide_beam(listed && (asked >> own & 1u) != 0u, scan, slot, own);
  }
}
