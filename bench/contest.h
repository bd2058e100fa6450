#pragma once
// Several casters on the same scans, in turn: what the machine does to one it does to all.

#include <memory>
#include <string>
#include <vector>

#include "bench/caster.h"
#include "bench/cost.h"
#include "bench/judge.h"

namespace sf::bench {

/// One caster's part in a contest.
struct Entrant {
  std::string method;
  std::vector<Cost> turns;  ///< one per turn
  Cost typical;             ///< medians of `turns`
  double ratio = 0.0;       ///< [-] median over turns of reference's time / its own; 0 without a reference
  double cpu_ratio = 0.0;   ///< [-] the same of time on all cores
  Verdict verdict;
  std::uint64_t hash = 0;  ///< of all ranges of round 0
};

struct Outcome {
  std::string scene;
  std::size_t robots = 0;
  std::size_t rays = 0;  ///< per turn
  double range_m = 0.0;
  std::vector<Entrant> entrants;
};

/// Every turn asks every caster once for the same round, in an order that rotates. Results are spoilt before and looked
/// at after; what is measured is the cast alone. All rounds are cast once before.
/// @param reference which method ratios refer to
Outcome compete(const Scans& scans, const std::vector<std::unique_ptr<Caster>>& casters, const std::string& reference,
                std::size_t turns);

/// [M/s] rays per second in the median turn.
inline double mrays_per_s(std::size_t rays, const Cost& cost) { return 1e-6 * static_cast<double>(rays) / cost.wall_s; }

}  // namespace sf::bench
