#include "sensors/cones/faces.h"

#include <cmath>

namespace sf::sensors {

Faces faces_of(const world::World& world) {
  Faces faces;
  const auto name = [&faces](world::Segment& s, std::uint32_t heading) {
    const double dx = s.b.x - s.a.x;
    const double dy = s.b.y - s.a.y;
    const double length = std::hypot(dx, dy);
    s.model = static_cast<std::uint32_t>(faces.rows.size());
    faces.rows.push_back({static_cast<float>(dx / length), static_cast<float>(dy / length), heading, 0});
  };
  for (const world::Segment& wall : world.walls) {
    if (!wall.seen_by_laser) continue;
    faces.world.walls.push_back(wall);
    name(faces.world.walls.back(), 0);
  }
  faces.world.movers = world.movers;
  for (std::uint32_t m = 0; m < faces.world.movers.size(); ++m)
    for (world::Segment& s : faces.world.movers[m].body) name(s, m + 1);
  return faces;
}

}  // namespace sf::sensors
