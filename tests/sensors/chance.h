#pragma once
// Random numbers for tests, the same on every machine.

#include <cstdint>

#include "base/pose.h"
#include "base/random.h"

namespace sf::trial {

/// Numbers drawn in sequence from `seed`.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : seed_(seed) {}
  /// Returns a uniform number in (low, high).
  double between(double low, double high) {
    return low + (high - low) * base::random_uniform({seed_, base::RandomStream::placement, 77, 0, count_++}, 0)[0];
  }
  /// Returns a uniform number in {0, ..., count - 1}.
  std::uint32_t below(std::uint32_t count) {
    return base::random_words({seed_, base::RandomStream::placement, 78, 0, count_++}, 0)[0] % count;
  }
  glm::dvec2 in_square(double half) {
    const double x = between(-half, half);
    return {x, between(-half, half)};
  }

 private:
  std::uint64_t seed_;
  std::uint64_t count_ = 0;
};

}  // namespace sf::trial
