#pragma once
// Compares Stage with the farm: the same cave, robots, scanners and start poses; each simulator has its own wandering
// controller.

#include <vector>

#include "bench/measurements.h"

namespace sf::bench {

/// Runs Stage without its window in turns with the farm, for 100, 300 and 1000 robots. The environment variable STAGE
/// is the path of its program (4.3); without it, the result is empty. Loading time is subtracted for both.
std::vector<Measurement> measure_beside_stage(gpu::Device& device);

}  // namespace sf::bench
