#pragma once
// Compares casters on the same scans. Casters take turns, so that changes in machine load affect all of them equally.

#include <memory>
#include <string>
#include <vector>

#include "bench/accuracy_check.h"
#include "bench/caster.h"
#include "bench/cost.h"

namespace sf::bench {

/// Result of one caster.
struct MethodResult : Timing {
  AccuracyCheck accuracy;
  std::uint64_t hash = 0;  ///< of all ranges of round 0
};

struct Comparison {
  std::string scene;
  std::size_t robots = 0;
  std::size_t rays = 0;  ///< per turn
  double range_m = 0.0;
  std::vector<MethodResult> method_results;
};

/// In every turn, each caster casts the same round once, in rotating order. Only the cast is timed; results are
/// poisoned before it and checked after it. All rounds are cast once for warm-up.
/// @param peer prefix of caster names; ratios refer to the best of these casters, the one with the least processor time
Comparison compare(const Scans& scans, const std::vector<std::unique_ptr<Caster>>& casters, const std::string& peer,
                   std::size_t repeats);

/// [M/s] Returns the rays per second in the median turn.
inline double mrays_per_s(std::size_t rays, const Cost& cost) { return 1e-6 * static_cast<double>(rays) / cost.wall_s; }

}  // namespace sf::bench
