#pragma once
// What a laser covers, for the eye only: a picture's worth of beams against the walls near it, none of the farm's
// exactness.

#include <vector>

#include "world/world.h"

namespace sf::viz {

/// The ends of `beams` >= 2 beams spread over the field of view, in order of bearing, each at the first wall that spans
/// the sensor's height or at range_max. Movers are looked through. [m] world frame
std::vector<glm::dvec2> visible_points(const world::World& world, const base::Pose& X_WS, const world::Laser& laser,
                                       int beams);

}  // namespace sf::viz
