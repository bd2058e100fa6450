#include "tests/sensors/brute_force.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sf::oracle {

using Wide = long double;

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

Answer cast(std::span<const world::Segment> surfaces, glm::dvec2 origin, long double direction, double range_max) {
  const Wide dx = std::cos(direction);
  const Wide dy = std::sin(direction);
  Wide best = range_max;
  Answer answer{range_max, 0xFFFFFFFFu, std::numeric_limits<double>::infinity()};
  for (const world::Segment& s : surfaces) {
    const Wide wx = static_cast<Wide>(s.a.x) - origin.x;
    const Wide wy = static_cast<Wide>(s.a.y) - origin.y;
    const Wide ex = static_cast<Wide>(s.b.x) - s.a.x;
    const Wide ey = static_cast<Wide>(s.b.y) - s.a.y;
    const Wide below = ex * dy - ey * dx;
    if (below == 0) continue;
    const Wide t = (ex * wy - ey * wx) / below;
    const Wide u = (dx * wy - dy * wx) / below;
    if (t < 0 || t >= best || u < 0 || u > 1) continue;
    best = t;
    answer.model = s.model;
  }
  answer.range = static_cast<double>(best);
  for (const world::Segment& s : surfaces)
    for (const glm::dvec2& end : {s.a, s.b}) {
      const Wide ahead = (end.x - origin.x) * dx + (end.y - origin.y) * dy;
      const Wide aside = (end.x - origin.x) * dy - (end.y - origin.y) * dx;
      if (ahead > -1e-6L && ahead <= best + 1e-6L)
        answer.silhouette = std::min(answer.silhouette, static_cast<double>(std::fabs(aside)));
    }
  return answer;
}

}  // namespace sf::oracle
