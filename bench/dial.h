#pragma once
// The laser's accuracy modes, and cheaper ways that did not become modes: speed against error, in turn, on standing
// walls.

#include <string>
#include <vector>

#include "bench/contest.h"
#include "gpu/device.h"

namespace sf::bench {

struct DialEntry {
  std::string method;
  Cost typical;
  double ratio = 0.0;                         ///< [-] clock, of mode exact's time to its own
  double cpu_ratio = 0.0;                     ///< [-] of time on all cores
  double median = 0.0, p99 = 0.0, max = 0.0;  ///< [m] errors against mode exact, all beams of the last turn's round
};

struct DialOutcome {
  std::size_t robots = 0;
  double range_m = 0.0;
  std::vector<DialEntry> entries;
};

DialOutcome compete_dial(gpu::Device& device, std::uint32_t robots, double range, std::size_t turns);

/// A Markdown table, and dial.csv.
std::string dial_table(const std::vector<DialOutcome>& outcomes);
void write_dial(const std::vector<DialOutcome>& outcomes, const std::string& folder);

}  // namespace sf::bench
