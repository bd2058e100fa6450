// Errors of positions measured by cameras.

#include "server/camera_positions.h"

#include <gtest/gtest.h>

namespace sf::server {
namespace {

TEST(PositionErrors, RootMeanSquareAndMaximum) {
  PositionErrors errors;
  EXPECT_EQ(errors.rms(), 0.0) << "of none";
  add(errors, {3.0, 4.0, 9.0, 3.1}, {0.0, 0.0, 0.0, -3.1});
  add(errors, {1.0, 1.0, 0.0, 0.25}, {1.0, 2.0, 0.0, 0.0});
  EXPECT_EQ(errors.count, 2u);
  EXPECT_DOUBLE_EQ(errors.rms(), std::sqrt(0.5 * (25.0 + 1.0)));
  EXPECT_EQ(errors.largest, 5.0) << "heights do not count";
  EXPECT_DOUBLE_EQ(errors.largest_heading, 0.25) << "3.1 and -3.1 are 0.083 apart";
}

}  // namespace
}  // namespace sf::server
