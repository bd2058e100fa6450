#pragma once
// The laser's accuracy modes, and cheaper ways that did not become modes: speed against error, in turn, on standing
// walls.

#include <string>
#include <vector>

#include "bench/comparison.h"
#include "gpu/device.h"

namespace sf::bench {

struct AccuracyModeResult {
  std::string method;
  Cost typical;
  double ratio = 0.0;                         ///< [-] clock, of mode exact's time to its own
  double cpu_ratio = 0.0;                     ///< [-] of time on all cores
  double median = 0.0, p99 = 0.0, max = 0.0;  ///< [m] errors against mode exact, all beams of the last turn's round
};

struct AccuracyModeComparison {
  std::size_t robots = 0;
  double range_m = 0.0;
  std::vector<AccuracyModeResult> entries;
};

AccuracyModeComparison compare_accuracy_modes(gpu::Device& device, std::uint32_t robots, double range,
                                              std::size_t repeats);

/// A Markdown table, and dial.csv.
std::string accuracy_mode_table(const std::vector<AccuracyModeComparison>& comparisons);
void write_accuracy_modes(const std::vector<AccuracyModeComparison>& comparisons, const std::string& folder);

}  // namespace sf::bench
