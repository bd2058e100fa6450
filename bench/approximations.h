#pragma once
// Cheaper scan methods outside of the farm, for comparison with its modes.

#include "bench/caster.h"

namespace sf::bench {

/// Creates a caster with 32-bit sphere tracing through a grid of distances to the nearest wall: a ray ends in the first
/// cell that a wall touches (J. C. Hart, "Sphere tracing", The Visual Computer 12, 1996). `scans` must outlive it.
/// @param cell [m]
std::unique_ptr<Caster> make_march_caster(const Scans& scans, double cell);

/// Creates a caster that predicts without casting: it transforms the previous, error-free scan to the robot's new pose
/// and connects its points with straight lines. `before` provides that scan and must outlive it.
std::unique_ptr<Caster> make_predicting_caster(const Scans& scans, const Caster& before, std::size_t round_before);

}  // namespace sf::bench
