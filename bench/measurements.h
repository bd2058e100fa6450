#pragma once
// Single measurements: start-up, empty ticks, whole fleets, lists.

#include <string>
#include <vector>

#include "gpu/device.h"

namespace sf::bench {

struct Measurement {
  std::string what;
  double value = 0.0;
  std::string unit;
};

/// Measures the time from opening the device to the first reading, with and without the driver's cache of compiled
/// kernels. Temporarily changes environment variables of this process.
std::vector<Measurement> measure_start();

/// Measures ticks with almost no work, and one sensor with much work.
std::vector<Measurement> measure_ticks(gpu::Device& device);

/// Runs whole fleets in closed loop with controllers, motion and all sensors, relative to simulated time: SimVille's
/// traffic (experiments/simville.toml, whose expectations must be met) and, if the file exists, 1000 wandering robots
/// in Stage's hospital (two runs with equal readings).
std::vector<Measurement> measure_fleets(gpu::Device& device);

/// Measures the cost of building the lists of a new cell.
std::vector<Measurement> measure_lists(gpu::Device& device);

}  // namespace sf::bench
