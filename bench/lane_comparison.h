#pragma once
// Compares whole ticks of lane edge sensors with the same algorithm in plain C++ on all cores.

#include <cstdint>
#include <string>
#include <vector>

#include "bench/cost.h"
#include "bench/lane_scene.h"
#include "gpu/device.h"

namespace sf::bench {

/// Result of one method.
struct LaneMethodResult : Timing {
  double worst = 0.0;      ///< [m] largest difference from the reference, over readings that both produce
  std::size_t alone = 0;   ///< number of readings that only one of the two produces
  std::uint64_t hash = 0;  ///< of all readings of round 0
};

struct LaneComparison {
  std::size_t sensors = 0;
  std::size_t rays = 0;                          ///< per turn
  double resolution = 0.0;                       ///< [m] of the raster; 0: exact markings
  std::size_t seen = 0;                          ///< number of sensors that see an edge in round 0
  std::vector<LaneMethodResult> method_results;  ///< ratios are relative to plain C++
};

/// In every turn, each method reads the same round once, in rotating order; results are poisoned before it. The
/// reference for exact markings is the tests' brute force with the fit on the host, for a sample of sensors. The
/// reference for a raster is plain C++, which traverses it in 64 bits.
LaneComparison compare_lanes(gpu::Device& device, const LaneScene& scene, std::size_t repeats);

/// Writes lanes.csv into `folder`; without measurements, keeps the old file.
/// @throws base::InputError if it cannot be written
void write_lanes(const std::vector<LaneComparison>& comparisons, const std::string& folder);
/// The same as text.
std::string lane_table(const std::vector<LaneComparison>& comparisons);

}  // namespace sf::bench
