#include "tests/sensors/brute_force.h"

#include <algorithm>

namespace sf::oracle {

std::vector<world::Segment> surfaces(const world::World& world, std::span<const base::Pose> poses, std::uint32_t self,
                                     double z) {
  std::vector<world::Segment> all;
  for (const world::Segment& s : world.walls)
    if (s.seen_by_laser && s.z_min <= z && z < s.z_max) all.push_back(s);
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    if (m == self) continue;
    for (world::Segment s : world.movers[m].body) {
      if (!s.seen_by_laser || z < poses[m].z + s.z_min || z >= poses[m].z + s.z_max) continue;
      s.a = base::transform(poses[m], s.a);
      s.b = base::transform(poses[m], s.b);
      all.push_back(s);
    }
  }
  return all;
}

std::vector<world::Segment> within(std::span<const world::Segment> all, glm::dvec2 origin, double range) {
  std::vector<world::Segment> near;
  const double reach = 1.001 * range + 0.001;
  for (const world::Segment& s : all) {
    const bool aside_x = std::max(s.a.x, s.b.x) < origin.x - reach || std::min(s.a.x, s.b.x) > origin.x + reach;
    const bool aside_y = std::max(s.a.y, s.b.y) < origin.y - reach || std::min(s.a.y, s.b.y) > origin.y + reach;
    if (!aside_x && !aside_y) near.push_back(s);
  }
  return near;
}

}  // namespace sf::oracle
