#include "cluster/shares.h"

#include <algorithm>
#include <numeric>
#include <thread>

namespace sf::cluster {

std::vector<std::uint32_t> equal_shares(std::span<const double> costs, unsigned shares) {
  const double whole = std::accumulate(costs.begin(), costs.end(), 0.0);
  std::vector<std::uint32_t> first{0};
  double before = 0.0;
  std::uint32_t at = 0;
  for (unsigned k = 1; k < shares; ++k) {
    // An item belongs to the share that contains its middle.
    const double due = whole * k / shares;
    while (at < costs.size() && before + 0.5 * costs[at] < due) before += costs[at++];
    first.push_back(at);
  }
  first.push_back(static_cast<std::uint32_t>(costs.size()));
  return first;
}

unsigned threads_of(unsigned wanted, const Ranks* ranks) {
  if (ranks == nullptr || wanted > 0) return wanted;
  return std::max(1u, std::thread::hardware_concurrency() / ranks->local_size());
}

}  // namespace sf::cluster
