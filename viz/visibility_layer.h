#pragma once
// The area that a laser covers, for display only: a few beams against nearby walls, without the farm's accuracy.

#include <vector>

#include "raycast/beams.h"
#include "world/world.h"

namespace sf::viz {

/// Returns the ends of `beams` >= 2 beams over the field of view, sorted by bearing, each at the first wall at the
/// sensor's height or at range_max. Ignores movers. [m] world frame
std::vector<glm::dvec2> visible_points(const world::World& world, const base::Pose& X_WS,
                                       const raycast::ScanSettings& scan, int beams);

}  // namespace sf::viz
