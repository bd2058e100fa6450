#pragma once
// Stage itself beside the farm: the same cave, robots, scanners and start poses, each with its own wandering.

#include <vector>

#include "bench/measurements.h"

namespace sf::bench {

/// Runs Stage without its window in turns with the farm, for 100, 300 and 1 000 robots. The environment's STAGE is its
/// program (4.3); without it there are no facts. Loading is left out of both.
std::vector<Measurement> measure_beside_stage(gpu::Device& device);

}  // namespace sf::bench
