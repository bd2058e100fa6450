// Ranges at the limits of their sensor.

#include "base/echo.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <vector>

namespace sf::base {
namespace {

constexpr double kMin = 0.25, kMax = 8.0;
double below(double x) { return std::nextafter(x, -HUGE_VAL); }
double above(double x) { return std::nextafter(x, HUGE_VAL); }

TEST(Echo, IsValidFromTheMinimumToBelowTheMaximum) {
  const RangeLimits limits{kMin, kMax};
  EXPECT_EQ(echo_of(-HUGE_VAL, limits), Echo::too_near) << "as recordings have it";
  EXPECT_EQ(echo_of(0.0, limits), Echo::too_near);
  EXPECT_EQ(echo_of(below(kMin), limits), Echo::too_near) << "the last number before the minimum";
  EXPECT_EQ(echo_of(kMin, limits), Echo::valid) << "at the minimum";
  EXPECT_EQ(echo_of(below(kMax), limits), Echo::valid) << "the last number before the maximum";
  EXPECT_EQ(echo_of(kMax, limits), Echo::none) << "at the maximum";
  EXPECT_EQ(echo_of(above(kMax), limits), Echo::none);
  EXPECT_EQ(echo_of(HUGE_VAL, limits), Echo::none);
  EXPECT_EQ(echo_of(NAN, limits), Echo::none);
  EXPECT_EQ(echo_of(0.0, {0.0, kMax}), Echo::valid) << "contact, without a minimum";
}

TEST(Echo, FloatsFollowRep117) {
  const RangeLimits limits{kMin, kMax};
  EXPECT_EQ(rep117_range(-HUGE_VAL, limits), -HUGE_VALF);
  EXPECT_EQ(rep117_range(below(kMin), limits), -HUGE_VALF) << "rounds to the minimum, and is too near";
  EXPECT_EQ(rep117_range(kMin, limits), 0.25F);
  EXPECT_EQ(rep117_range(7.9999999, limits), std::nextafter(8.0F, 0.0F)) << "rounds to the maximum, and is valid";
  EXPECT_EQ(rep117_range(kMax, limits), HUGE_VALF);
  EXPECT_EQ(rep117_range(HUGE_VAL, limits), HUGE_VALF);
  EXPECT_TRUE(std::isnan(rep117_range(NAN, limits)));
  EXPECT_EQ(rep117_range(0.7, {0.7, kMax}), std::nextafter(0.7F, 1.0F)) << "0.7F is less than 0.7";
}

TEST(Echo, LimitsOfMessagesAreRoundedOutwards) {
  EXPECT_EQ(float_below(0.25), 0.25F);
  EXPECT_EQ(float_above(8.0), 8.0F);
  EXPECT_EQ(float_below(0.7), 0.7F) << "0.7F is less than 0.7";
  EXPECT_EQ(float_above(0.7), std::nextafter(0.7F, 1.0F));
  EXPECT_EQ(float_below(0.1), std::nextafter(0.1F, 0.0F)) << "0.1F is more than 0.1";
  EXPECT_EQ(float_above(0.1), 0.1F);
}

/// Each valid range satisfies `range_min <= r` and `r < range_max`, for the message's limits and for the true ones.
RC_GTEST_PROP(Echo, ValidRangesSatisfyTheLimits, ()) {
  const auto number = [](int most) { return 1e-3 * *rc::gen::inRange(1, most) / 3.0; };
  const double min = number(1000), max = min + number(20'000);
  const std::vector<double> ranges{min, above(min), min + 0.5 * (max - min), below(max), max - 1e-9 * max};
  for (const double range : ranges) {
    const float sent = rep117_range(range, {min, max});
    RC_ASSERT(float_below(min) <= sent);
    RC_ASSERT(sent < float_above(max));
    RC_ASSERT(echo_of(sent, {min, max}) == Echo::valid);
    RC_ASSERT(std::abs(sent - range) <= 1.2e-7 * range);
  }
}

TEST(Echo, MarksTheRangesOfFlaggedElements) {
  using enum QualityFlag;
  std::vector<double> values{0.5, 1023.0, 0.5, 7.0, 2.0, 3.0};
  mark_too_near({}, values);
  EXPECT_EQ(values[0], 0.5) << "without flags";
  const QualityFlag flags[] = {too_near, grazing, none};
  mark_too_near(flags, values);
  EXPECT_EQ(values, (std::vector<double>{-HUGE_VAL, 1023.0, 0.5, 7.0, 2.0, 3.0})) << "of two columns the first";
}

}  // namespace
}  // namespace sf::base
