#pragma once
// Cheaper ways to a scan that the farm does not have, to be measured beside its modes.

#include "bench/caster.h"

namespace sf::bench {

/// Sphere tracing in 32 bits through a grid of distances to the nearest wall: a ray ends in the first cell that a wall
/// touches (J. C. Hart, "Sphere tracing", The Visual Computer 12, 1996). `scans` must outlive it.
/// @param cell [m]
std::unique_ptr<Caster> make_march_caster(const Scans& scans, double cell);

/// Prediction: the scan before, exactly as it was, seen from where the robot is now; what falls between its points lies
/// on straight lines. Casts nothing. `before` gives that scan and must outlive it.
std::unique_ptr<Caster> make_predicting_caster(const Scans& scans, const Caster& before, std::size_t round_before);

}  // namespace sf::bench
