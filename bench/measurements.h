#pragma once
// Single figures: what a start costs, what nothing costs.

#include <string>
#include <vector>

#include "gpu/device.h"

namespace sf::bench {

struct Measurement {
  std::string what;
  double value = 0.0;
  std::string unit;
};

/// From no device to the first reading, with and without the driver's cache of compiled kernels.
/// Changes the environment of this process while it runs.
std::vector<Measurement> measure_start();

/// Ticks that hardly do anything, and one sensor that does much.
std::vector<Measurement> measure_ticks(gpu::Device& device);

/// What it costs to make the lists of a cell that nobody has been in.
std::vector<Measurement> measure_lists(gpu::Device& device);

}  // namespace sf::bench
