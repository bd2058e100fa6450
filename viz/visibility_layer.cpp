#include "viz/visibility_layer.h"

#include <algorithm>

namespace sf::viz {
namespace {

using world::Segment;

/// A wall relative to the sensor.
struct Wall {
  glm::dvec2 a;
  glm::dvec2 along;
};

std::vector<Wall> walls_near(const world::World& world, const base::Pose& X_WS, double reach) {
  std::vector<Wall> near;
  const glm::dvec2 eye{X_WS.x, X_WS.y};
  for (const Segment& s : world.walls) {
    if (!s.seen_by_laser || X_WS.z < s.z_min || X_WS.z >= s.z_max) continue;
    const glm::dvec2 a = s.a - eye;
    const glm::dvec2 b = s.b - eye;
    const bool aside = std::min(a.x, b.x) > reach || std::max(a.x, b.x) < -reach;
    const bool beyond = std::min(a.y, b.y) > reach || std::max(a.y, b.y) < -reach;
    if (!aside && !beyond) near.push_back({a, b - a});
  }
  return near;
}

double range_along(const std::vector<Wall>& walls, glm::dvec2 d, double range_max) {
  double range = range_max;
  for (const Wall& wall : walls) {
    const double across = base::cross(d, wall.along);
    if (across == 0.0) continue;
    const double t = base::cross(wall.a, wall.along) / across;
    const double u = base::cross(wall.a, d) / across;
    if (t >= 0.0 && t < range && u >= 0.0 && u <= 1.0) range = t;
  }
  return range;
}

}  // namespace

std::vector<glm::dvec2> visible_points(const world::World& world, const base::Pose& X_WS,
                                       const raycast::ScanSettings& scan, int beams) {
  const std::vector<Wall> walls = walls_near(world, X_WS, scan.range_max);
  std::vector<glm::dvec2> ends;
  ends.reserve(static_cast<std::size_t>(beams));
  for (int k = 0; k < beams; ++k) {
    const double bearing = scan.fov * (static_cast<double>(k) / (beams - 1) - 0.5);
    const glm::dvec2 d = base::rotate(X_WS.yaw + bearing, {1.0, 0.0});
    ends.push_back(glm::dvec2{X_WS.x, X_WS.y} + range_along(walls, d, scan.range_max) * d);
  }
  return ends;
}

}  // namespace sf::viz
