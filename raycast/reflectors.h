#pragma once
// Subset of a world that reflects sound, with the direction of each segment. The angle of incidence determines whether
// an echo returns.

#include <vector>

#include "raycast/records.h"
#include "world/world.h"

namespace sf::raycast {

struct Reflectors {
  world::World world;  ///< walls and movers that reflect sound; `Segment::model` is an index into `rows`
  std::vector<ReflectorDirection> rows;  ///< one per segment
};

Reflectors reflectors_of(const world::World& world);

}  // namespace sf::raycast
