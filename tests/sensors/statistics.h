#pragma once
// Statistics of draws.

#include <algorithm>
#include <cmath>
#include <vector>

namespace sf::trial {

/// Returns the Kolmogorov-Smirnov distance of `draws` from the standard normal distribution, times the root of their
/// number: above 1.95 once in a thousand runs. Seeds are fixed, so results are reproducible.
inline double ks(std::vector<double> draws) {
  std::sort(draws.begin(), draws.end());
  const double n = static_cast<double>(draws.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < draws.size(); ++i) {
    const double p = 0.5 * std::erfc(-draws[i] / std::sqrt(2.0));
    worst = std::max({worst, std::fabs(p - static_cast<double>(i) / n), std::fabs(static_cast<double>(i + 1) / n - p)});
  }
  return worst * std::sqrt(n);
}

}  // namespace sf::trial
