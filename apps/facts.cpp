#include "apps/facts.h"

#include <algorithm>

namespace sf::apps {

std::size_t count_robots(const world::World& world) {
  std::size_t robots = 0;
  for (const world::Mover& mover : world.movers) robots += !mover.is_tag;
  return robots;
}

std::size_t count_docks(const world::World& world) {
  return static_cast<std::size_t>(
      std::count_if(world.emitters.begin(), world.emitters.end(),
                    [](const world::Emitter& e) { return e.kind == world::Emitter::Kind::dock; }));
}

std::size_t count_magnets(const world::World& world) {
  std::size_t magnets = world.magnets.size();
  for (const world::Mover& mover : world.movers) magnets += mover.magnets.size();
  return magnets;
}

}  // namespace sf::apps
