#pragma once
// Speed and error of the laser's accuracy modes, and of cheaper methods that did not become modes. Methods take turns;
// walls do not move.

#include <string>
#include <vector>

#include "bench/comparison.h"
#include "gpu/device.h"

namespace sf::bench {

struct AccuracyModeResult : Timing {
  double median = 0.0, p99 = 0.0, max = 0.0;  ///< [m] errors relative to mode exact, over all beams of the last turn
};

struct AccuracyModeComparison {
  std::size_t robots = 0;
  double range_m = 0.0;
  std::vector<AccuracyModeResult> entries;
};

AccuracyModeComparison compare_accuracy_modes(gpu::Device& device, std::uint32_t robots, double range,
                                              std::size_t repeats);

/// Returns a Markdown table.
std::string accuracy_mode_table(const std::vector<AccuracyModeComparison>& comparisons);
void write_accuracy_modes(const std::vector<AccuracyModeComparison>& comparisons, const std::string& folder);

}  // namespace sf::bench
