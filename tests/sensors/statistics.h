#pragma once
// Statistics of draws.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "farm/farm.h"
#include "tests/device.h"

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

/// Returns the correlation of two samples of mean 0 and variance 1.
inline double correlation(const std::vector<double>& p, const std::vector<double>& q, std::size_t lag = 0) {
  double sum = 0.0;
  for (std::size_t i = 0; i + lag < p.size(); ++i) sum += p[i] * q[i + lag];
  return sum / static_cast<double>(p.size() - lag);
}

/// Expects draws at each of `lags` to be uncorrelated, within 4 standard deviations.
inline void expect_uncorrelated(const std::vector<double>& draws, std::initializer_list<std::size_t> lags) {
  for (const std::size_t lag : lags)
    EXPECT_LT(std::fabs(correlation(draws, draws, lag)), 4.0 / std::sqrt(static_cast<double>(draws.size() - lag)))
        << "lag " << lag;
}

/// Calls `each(noisy, quiet)` with every reading of `ticks` ticks with and without noise, `interval` [ns] apart.
template <class Each>
void for_noisy_readings(const world::World& world, std::uint64_t seed, int ticks, std::int64_t interval, Each each) {
  farm::Farm noisy(world, device(), {.seed = seed}), quiet(world, device(), {.noise = false});
  noisy.subscribe_all();
  quiet.subscribe_all();
  for (int k = 0; k < ticks; ++k) {
    const auto with = noisy.tick(k * interval, {}), without = quiet.tick(k * interval, {});
    for (std::size_t r = 0; r < with.size(); ++r) each(with[r], without[r]);
  }
}

}  // namespace sf::trial
