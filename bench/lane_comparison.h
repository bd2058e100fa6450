#pragma once
// Whole ticks of lane edge sensors beside the same algorithm in plain C++ on all cores.

#include <cstdint>
#include <string>
#include <vector>

#include "bench/cost.h"
#include "bench/lane_scene.h"
#include "gpu/device.h"

namespace sf::bench {

/// One method's part.
struct LaneMethodResult {
  std::string method;
  std::vector<Cost> repeats;  ///< one per turn
  Cost typical;               ///< medians of `repeats`
  double ratio = 0.0;         ///< [-] median over turns of the plain peer's time / its own
  double cpu_ratio = 0.0;     ///< [-] the same of time on all cores
  double worst = 0.0;         ///< [m] largest difference to what the judge says, of readings that both have
  std::size_t alone = 0;      ///< readings that only one of the two has
  std::uint64_t hash = 0;     ///< of all readings of round 0
};

struct LaneComparison {
  std::size_t sensors = 0;
  std::size_t rays = 0;     ///< per turn
  double resolution = 0.0;  ///< [m] of the raster; 0: exact paint
  std::size_t seen = 0;     ///< sensors with an edge in sight in round 0
  std::vector<LaneMethodResult> method_results;
};

/// Every turn asks every method once for the same round, in an order that rotates; results are spoilt before. Exact
/// paint is judged by the tests' brute force and the fit on the host, for a sample of sensors; a raster by the plain
/// peer, which walks it in 64 bits.
LaneComparison compare_lanes(gpu::Device& device, const LaneScene& scene, std::size_t repeats);

/// Writes lanes.csv into `folder`; keeps the old one where nothing was measured. @throws base::InputError when it
/// cannot be written.
void write_lanes(const std::vector<LaneComparison>& comparisons, const std::string& folder);
/// The same as text for people.
std::string lane_table(const std::vector<LaneComparison>& comparisons);

}  // namespace sf::bench
