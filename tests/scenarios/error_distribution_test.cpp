#include "scenarios/error_distribution.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sf::scenarios {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

TEST(ErrorDistribution, WithoutErrorsIsZero) {
  const ErrorDistribution none;
  EXPECT_EQ(none.count(), 0u);
  EXPECT_EQ(none.zero(), 0.0);
  EXPECT_EQ(none.quantile(0.5), 0.0);
  EXPECT_EQ(none.bound(), kNone);
}

TEST(ErrorDistribution, CountsQuantilesAndBounds) {
  ErrorDistribution d;
  for (int i = 100; i >= 0; --i) d.add(1.0 + i, 1.0, i % 2 == 0 ? 200.0 + i : kNone);
  EXPECT_EQ(d.count(), 101u);
  EXPECT_DOUBLE_EQ(d.zero(), 1.0 / 101.0);
  EXPECT_EQ(d.quantile(0.0), 0.0);
  EXPECT_EQ(d.quantile(0.5), 50.0);
  EXPECT_EQ(d.quantile(0.99), 99.0);
  EXPECT_EQ(d.quantile(1.0), 100.0);
  EXPECT_EQ(d.max(), 100.0);
  EXPECT_DOUBLE_EQ(d.covered(), 51.0 / 101.0);
  EXPECT_EQ(d.covered_max(), 100.0);
  EXPECT_EQ(d.bound(), 300.0) << "the largest";
}

TEST(ErrorDistribution, NonFiniteValues) {
  ErrorDistribution d;
  d.add(NAN, NAN, kNone);
  d.add(HUGE_VAL, HUGE_VAL, kNone);
  EXPECT_EQ(d.max(), 0.0) << "without any value";
  d.add(1.0, NAN, kNone);
  EXPECT_EQ(d.max(), HUGE_VAL);
  EXPECT_DOUBLE_EQ(d.zero(), 2.0 / 3.0);
}

/// Quantiles come from a sample; everything else is exact.
TEST(ErrorDistribution, ManyErrorsAreSampledEvenly) {
  ErrorDistribution d;
  constexpr int kMany = 9'000'000;
  for (int i = 0; i < kMany; ++i) d.add(i, 0.0, kNone);
  EXPECT_EQ(d.count(), static_cast<std::uint64_t>(kMany));
  EXPECT_EQ(d.max(), kMany - 1.0);
  EXPECT_NEAR(d.quantile(0.5), 0.5 * kMany, 8.0);
  EXPECT_NEAR(d.quantile(0.99), 0.99 * kMany, 8.0);
}

TEST(CoveringBound, OnlyForUnflaggedElements) {
  base::ReadingBlock reading;
  reading.bound = 0.5;
  EXPECT_EQ(covering_bound(reading, 3, 1.0), 0.5) << "without flags it holds for all";
  const std::vector<base::QualityFlag> quality = {base::QualityFlag::none, base::QualityFlag::not_cast};
  reading.quality = quality;
  EXPECT_EQ(covering_bound(reading, 0, 1.0), 0.5);
  EXPECT_EQ(covering_bound(reading, 1, 1.0), kNone);
  EXPECT_EQ(covering_bound(reading, 0, NAN), kNone);
}

}  // namespace
}  // namespace sf::scenarios
