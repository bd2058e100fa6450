#pragma once
// Cheaper scan methods that are not part of the farm, for comparison with its modes.

#include "bench/caster.h"

namespace sf::bench {

/// Sphere tracing in 32 bits through a grid of distances to the nearest wall: a ray ends in the first cell that a wall
/// touches (J. C. Hart, "Sphere tracing", The Visual Computer 12, 1996). `scans` must outlive it.
/// @param cell [m]
std::unique_ptr<Caster> make_march_caster(const Scans& scans, double cell);

/// Prediction without casting: the previous scan, without error, seen from the robot's new pose, with straight lines
/// between its points. `before` provides that scan and must outlive it.
std::unique_ptr<Caster> make_predicting_caster(const Scans& scans, const Caster& before, std::size_t round_before);

}  // namespace sf::bench
