// Bodies on ramps, decks and the floor.

#include "world/ground.h"

#include <gtest/gtest.h>

#include <vector>

namespace sf::world {
namespace {

/// A ramp from x = 0 to 2 m, a deck 0.4 m high up to 4 m, and a ramp down to 6 m; half a metre wide.
const std::vector<Ramp> kBridge{
    {{0, 0}, {2, 0}, 0.0, 0.4, 0.25}, {{2, 0}, {4, 0}, 0.4, 0.4, 0.25}, {{4, 0}, {6, 0}, 0.4, 0.0, 0.25}};

/// Returns z after moves of `step` [m] along x, at `y`, from `x` and `z`.
double drive(double x, double y, double z, double to, double step = 0.02) {
  const Ground ground(kBridge);
  const double sign = to > x ? 1.0 : -1.0;
  while (sign * (to - x) > 1e-9) {
    const double next = sign * (to - x) < step ? to : x + sign * step;
    z = ground.follow({x, y, z, 0.0}, {next, y});
    x = next;
  }
  return z;
}

TEST(Ground, HeightsAreThoseOfTheHighestSurfaceBelow) {
  const Ground ground(kBridge);
  EXPECT_EQ(ground.height({1.0, 0.0}, 1.0), 0.2);
  EXPECT_EQ(ground.height({1.0, 0.0}, 0.1), 0.0) << "the ramp is above";
  EXPECT_NEAR(ground.at({1.0, 0.0}, 1.0).slope.x, 0.2, 1e-15);
  EXPECT_EQ(ground.at({3.0, 0.0}, 1.0).slope.x, 0.0) << "the deck is level";
  EXPECT_EQ(ground.height({3.0, 0.25}, 0.4), 0.4) << "its edge belongs to the deck";
  EXPECT_EQ(ground.height({3.0, 0.26}, 1.0), 0.0) << "beyond its edge";
  EXPECT_EQ(ground.height({-0.3, 0.0}, 1.0), 0.0);
  EXPECT_TRUE(Ground({}).is_flat());
  EXPECT_EQ(Ground({}).height({1.0, 2.0}, 5.0), 0.0);
}

TEST(Ground, BodiesClimbRampsInBothDirections) {
  EXPECT_NEAR(drive(-1.0, 0.0, 0.0, 1.0), 0.2, 1e-12);
  EXPECT_EQ(drive(-1.0, 0.1, 0.0, 3.0), 0.4);
  EXPECT_EQ(drive(-1.0, 0.1, 0.0, 7.0), 0.0) << "up and down, without rounding errors left";
  EXPECT_EQ(drive(7.0, 0.0, 0.0, 3.0), 0.4);
  EXPECT_EQ(drive(-1.0, 0.0, 0.0, 3.0, 1.9), 0.4) << "in long steps";
}

TEST(Ground, BodiesPassUnderAndDropOff) {
  const Ground ground(kBridge);
  EXPECT_EQ(ground.follow({3.0, -0.7, 0.0, 0.0}, {3.0, -0.1}), 0.0) << "under the deck";
  EXPECT_EQ(ground.follow({3.0, -0.1, 0.0, 0.0}, {3.0, 0.1}), 0.0);
  EXPECT_EQ(ground.follow({3.0, 0.2, 0.4, 0.0}, {3.0, 0.3}), 0.0) << "off the deck";
  EXPECT_NEAR(ground.follow({0.2, 0.3, 0.0, 0.0}, {0.2, 0.24}), 0.04, 1e-12) << "a kerb of 4 cm";
  EXPECT_EQ(ground.follow({0.9, 0.26, 0.0, 0.0}, {0.9, 0.24}), 0.0) << "18 cm are no kerb";
}

/// Boundary: 1 cm above or below a surface is on it.
TEST(Ground, BodiesAboveASurfaceKeepTheirHeight) {
  EXPECT_NEAR(drive(-1.0, 0.0, 0.3, 3.0), 0.7, 1e-12);
  EXPECT_EQ(drive(2.5, 0.0, 0.409, 3.0), 0.4);
  EXPECT_EQ(drive(2.5, 0.0, 0.391, 3.0), 0.4);
  EXPECT_NEAR(drive(2.5, 0.0, 0.389, 3.0), 0.389, 1e-12) << "under the deck, above the floor";
  EXPECT_EQ(drive(-2.0, 0.0, -0.5, -1.0), -0.5) << "below the floor";
}

}  // namespace
}  // namespace sf::world
