#pragma once
// Runs of whole fleets in closed loop with controllers, motion and all sensors, relative to simulated time.

#include <vector>

#include "bench/measurements.h"

namespace sf::bench {

/// Runs SimVille's traffic (experiments/simville.toml, whose expectations must be met) and, if the file exists, 1000
/// wandering robots in Stage's hospital (two runs with equal readings).
std::vector<Measurement> measure_fleets(gpu::Device& device);

}  // namespace sf::bench
