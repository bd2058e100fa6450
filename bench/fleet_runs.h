#pragma once
// Whole fleets in the loop: controllers, motion and every sensor, against simulated time.

#include <vector>

#include "bench/measurements.h"

namespace sf::bench {

/// SimVille's traffic (experiments/simville.toml, which must meet what it expects) and, where the file is there, 1 000
/// robots that wander in Stage's hospital (two runs, which must give the same readings).
std::vector<Measurement> measure_fleets(gpu::Device& device);

}  // namespace sf::bench
