#pragma once
// Integration of scans into the maps of a fleet: compares the farm's batch with the plain mapper on all cores.

#include <cstdint>
#include <string>
#include <vector>

#include "bench/cost.h"
#include "gpu/device.h"

namespace sf::bench {

/// Result of one method.
struct MapMethodResult : Timing {
  std::size_t different = 0;  ///< words in all maps that differ from the plain mapper's
  std::uint64_t hash = 0;     ///< of all maps after the last turn
};

struct MapComparison {
  std::size_t robots = 0;
  std::size_t beams = 0;  ///< per turn
  double range_m = 0.0;
  bool weighs = false;                          ///< uses log odds instead of three states
  std::vector<MapMethodResult> method_results;  ///< ratios are relative to plain C++
};

/// In every turn, each method receives the same scans once, in rotating order: robots in the cave, each with a separate
/// map of 3 cm cells that covers its range.
MapComparison compare_maps(gpu::Device& device, std::uint32_t robots, double range, bool weighs, std::size_t repeats);

/// Writes maps.csv into `folder`; without measurements, keeps the old file.
/// @throws base::InputError if it cannot be written
void write_maps(const std::vector<MapComparison>& comparisons, const std::string& folder);
/// The same as text.
std::string map_table(const std::vector<MapComparison>& comparisons);

}  // namespace sf::bench
