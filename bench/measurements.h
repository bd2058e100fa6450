#pragma once
// Single measurements: start-up, empty ticks, lists.

#include <string>
#include <vector>

#include "gpu/device.h"

namespace sf::bench {

struct Measurement {
  std::string what;
  double value = 0.0;
  std::string unit;
};

/// Time from opening the device to the first reading, with and without the driver's cache of compiled kernels. Changes
/// environment variables of this process meanwhile.
std::vector<Measurement> measure_start();

/// Ticks with almost no work, and one sensor with much.
std::vector<Measurement> measure_ticks(gpu::Device& device);

/// Cost of making the lists of a new cell.
std::vector<Measurement> measure_lists(gpu::Device& device);

}  // namespace sf::bench
