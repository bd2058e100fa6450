#include "control/error_summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sf::control {
namespace {

/// Boundaries: an error below zero, and steps without one (NaN, infinity).
TEST(ErrorSummary, AveragesStatedErrors) {
  ErrorSummary summary;
  for (const double error : {1.0, -3.0, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) add(summary, error);
  EXPECT_EQ(summary.steps, 2u);
  EXPECT_DOUBLE_EQ(summary.mean, -1.0);
  EXPECT_DOUBLE_EQ(summary.abs_mean, 2.0);
}

}  // namespace
}  // namespace sf::control
