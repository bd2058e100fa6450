#pragma once
// What sonar may hear of a world, as a world of its own whose segments say which way they run: how flatly a beam meets
// a surface decides whether its echo comes back.

#include <vector>

#include "sensors/cones/records.h"
#include "world/world.h"

namespace sf::sensors {

struct Reflectors {
  world::World world;                    ///< walls and movers that echo; `Segment::model` is a row of `rows`
  std::vector<ReflectorDirection> rows;  ///< one per segment
};

Reflectors reflectors_of(const world::World& world);

}  // namespace sf::sensors
