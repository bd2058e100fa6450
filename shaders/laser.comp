#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_vote : require
// Casts every beam of all due sensors. Lists the lanes that have a beam whose nearest surface 32 bits cannot certify.

#include "shaders/raycast/records.glsl"

layout(local_size_x = SF_LANES_PER_GROUP) in;  // raycast/records.h
#include "shaders/lib/laser_lane.glsl"
#include "shaders/lib/list_search.glsl"

// The nearest surface is initially at the end of the range.
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

// Evaluates the nearest segments in 64 bits. Returns the uncertain beams, one bit each.
uint measure(Search s, Beam64 beams[SF_BEAMS_PER_LANE], double range_max, out ClosestHit closest[SF_BEAMS_PER_LANE]) {
  uint uncertain = 0u;
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    uncertain |= s.low[i] > s.others[i] ? 0u : 1u << i;
    const uint id = s.entry[i] < 0 ? SF_NO_HIT : imageLoad(segment_ids, max(s.entry[i], 0)).x + uint(s.first_row[i]);
    closest[i] = ClosestHit(exact_range(id, beams[i], range_max), id, vec3(0.0));
  }
  return uncertain;
}

// Adds a lane to the list for the next dispatch, which runs one invocation for each beam of the lane.
void list_uncertain(int lane, uint beams) {
  const uint slot = atomicAdd(uncertain.count, 1u);
  uncertain.lanes[slot] = uvec2(lane, SF_UNCERTAIN * beams);
  const uint group = slot / (SF_LANES_PER_GROUP / SF_BEAMS_PER_LANE);
  atomicMax(uncertain.across, min(group + 1u, SF_UNCERTAIN_GROUPS_ACROSS));
  atomicMax(uncertain.down, group / SF_UNCERTAIN_GROUPS_ACROSS + 1u);
}

void main() {
  const int lane = invocation();
  const ScanLane scan = scan_lane(lane);
  Search s = begin_search(scan.beams, scan.row.range_max);
  search_lists(scan.walls, scan.movers, vec2(scan.row.offset_x, scan.row.offset_y),
               dvec2(scan.row.origin_x, scan.row.origin_y), scan.row.band, s);
  ClosestHit closest[SF_BEAMS_PER_LANE];
  const uint uncertain_beams = measure(s, scan.beams, scan.row.range_max, closest);
  store(scan, closest);
  if (uncertain_beams != 0u) list_uncertain(lane, uncertain_beams);
}
