#include "sensors/pixel_samples.h"

#include <algorithm>
#include <climits>
#include <cstdlib>
#include <glm/common.hpp>
#include <numeric>

namespace sf::sensors {

namespace {

/// Least squared distance, [1/n px], between points (i, i step mod n) of a pixel and its neighbours.
int spread_of(int n, int step) {
  int least = INT_MAX;
  for (int i = 1; i < n; ++i) {
    const int x = std::min(i, n - i), y = i * step % n, across = std::min(y, n - y);
    least = std::min(least, x * x + across * across);
  }
  return least;
}

/// Twice the place of a row or column from the middle, [1/n px].
int from_middle(int n, int row) { return 2 * row + 1 - n; }

/// Point i is at (i, (i step + first) mod n).
struct Lattice {
  int step = 1, first = 0;
  int quality = -1;  ///< four times the least squared distance, also from the middle, [1/n px]
};

Lattice best_lattice(int n) {
  Lattice best;
  for (int step = 1; step <= n; ++step) {
    if (std::gcd(step, n) != 1) continue;
    for (int first = 0; first < n; ++first) {
      int quality = n > 1 ? 4 * spread_of(n, step) : 0;
      for (int i = 0; i < n; ++i) {
        const int x = from_middle(n, i), y = from_middle(n, (i * step + first) % n);
        quality = std::min(quality, x * x + y * y);
      }
      if (quality > best.quality) best = {step, first, quality};
    }
  }
  return best;
}

/// Point k of an exposure is row (k stride + first) of the lattice.
struct Order {
  int stride = 1, first = 0;
  int drift = INT_MAX;  ///< sum of the points' places along an axis times their numbers
};

/// Finds the order in which points drift least while they are exposed.
Order best_order(int n, const Lattice& lattice) {
  Order best;
  for (int stride = 1; stride <= n; ++stride) {
    if (std::gcd(stride, n) != 1) continue;
    for (int first = 0; first < n; ++first) {
      int x = 0, y = 0;
      for (int k = 0; k < n; ++k) {
        const int i = (k * stride + first) % n;
        x += k * from_middle(n, i), y += k * from_middle(n, (i * lattice.step + lattice.first) % n);
      }
      const int drift = std::max(std::abs(x), std::abs(y));
      if (drift < best.drift) best = {stride, first, drift};
    }
  }
  return best;
}

}  // namespace

PixelSamples::PixelSamples(std::uint32_t count) {
  if (count == 1) return;
  const auto n = static_cast<int>(count - 1);
  const Lattice lattice = best_lattice(n);
  const Order order = best_order(n, lattice);
  for (int k = 0; k < n; ++k) {
    const int i = (k * order.stride + order.first) % n;
    places_.push_back(0.5 / n * glm::dvec2(from_middle(n, i), from_middle(n, (i * lattice.step + lattice.first) % n)));
  }
}

glm::dvec2 PixelSamples::at(std::uint32_t k, std::uint32_t u, std::uint32_t v) const {
  if (k == 0) return {};
  // M. Roberts' R2 sequence along rows, and along columns.
  constexpr double kA = 0.7548776662466927, kB = 0.5698402909980532;
  const glm::dvec2 turn(u * kA + v * kB, u * kB + v * kA);
  return places_[k - 1] + (turn - glm::floor(turn) - 0.5) / static_cast<double>(places_.size());
}

}  // namespace sf::sensors
