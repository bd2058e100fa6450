// Random numbers as a pure function of their key.

#include "base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace sf::base {
namespace {

constexpr RandomKey kKey{42, RandomStream::range_noise, 1, 2, 3};

/// Changing any field of the key, or the index, changes the numbers.
TEST(Random, EveryFieldMatters) {
  std::set<std::array<std::uint32_t, 4>> seen{random_words(kKey, 0), random_words(kKey, 1)};
  for (int field = 0; field < 7; ++field) {
    RandomKey d = kKey;
    if (field == 0) d.seed += 1;
    if (field == 1) d.seed += std::uint64_t{1} << 32;
    if (field == 2) d.stream = RandomStream::angle_noise;
    if (field == 3) d.a += 1;
    if (field == 4) d.b += 1;
    if (field == 5) d.c += 1;
    if (field == 6) d.c += std::uint64_t{1} << 32;
    EXPECT_TRUE(seen.insert(random_words(d, 0)).second) << "field " << field;
  }
}

TEST(Random, UniformIsInOpenIntervalAndEven) {
  double sum = 0.0, squares = 0.0;
  constexpr std::uint32_t kCount = 100'000;
  for (std::uint32_t i = 0; i < kCount; ++i)
    for (const double u : random_uniform(kKey, i)) {
      ASSERT_GT(u, 0.0);
      ASSERT_LT(u, 1.0);
      sum += u;
      squares += u * u;
    }
  // Tolerances: four standard deviations of the mean of u and of u^2.
  EXPECT_NEAR(sum / (2 * kCount), 0.5, 4 * std::sqrt(1.0 / 12 / (2 * kCount)));
  EXPECT_NEAR(squares / (2 * kCount), 1.0 / 3, 4 * std::sqrt(4.0 / 45 / (2 * kCount)));
}

TEST(Random, NormalHasStandardMoments) {
  double mean = 0.0, variance = 0.0, fourth = 0.0, both = 0.0;
  constexpr std::uint32_t kCount = 200'000;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const auto n = random_normal(kKey, i);
    mean += n[0] / kCount;
    variance += n[0] * n[0] / kCount;
    fourth += n[0] * n[0] * n[0] * n[0] / kCount;
    both += n[0] * n[1] / kCount;
  }
  const double deviation = 1.0 / std::sqrt(double{kCount});
  EXPECT_NEAR(mean, 0.0, 4 * deviation);
  EXPECT_NEAR(variance, 1.0, 4 * std::sqrt(2.0) * deviation);
  EXPECT_NEAR(fourth, 3.0, 4 * std::sqrt(96.0) * deviation);
  EXPECT_NEAR(both, 0.0, 4 * deviation) << "the two numbers of a draw are independent";
}

}  // namespace
}  // namespace sf::base
