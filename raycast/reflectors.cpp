#include "raycast/reflectors.h"

#include <cmath>

#include "base/elementary.h"

namespace sf::raycast {

Reflectors reflectors_of(const world::World& world) {
  Reflectors reflectors;
  const auto name = [&reflectors](world::Segment& s, std::uint32_t heading) {
    const double dx = s.b.x - s.a.x;
    const double dy = s.b.y - s.a.y;
    const double length = base::hypot(dx, dy);
    s.model = static_cast<std::uint32_t>(reflectors.rows.size());
    reflectors.rows.push_back({static_cast<float>(dx / length), static_cast<float>(dy / length), heading, 0});
  };
  for (const world::Segment& wall : world.walls) {
    if (!wall.seen_by_laser) continue;
    reflectors.world.walls.push_back(wall);
    name(reflectors.world.walls.back(), 0);
  }
  reflectors.world.movers = world.movers;
  reflectors.world.copies = world.copies;
  for (std::uint32_t m = 0; m < reflectors.world.movers.size(); ++m)
    for (world::Segment& s : reflectors.world.movers[m].body) name(s, m + 1);
  return reflectors;
}

}  // namespace sf::raycast
