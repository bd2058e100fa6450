// Bodies on ramps, decks and the floor.

#include "world/ground.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

/// Walks from a kerb of 4 cm and its corner to where a wheel of 0.1 m no longer touches it.
TEST(Ground, WheelsRollOverEdges) {
  const std::vector<Ramp> kerb{{{0, 0}, {1, 0}, 0.04, 0.04, 1.0}};  // 5 cm longer at both ends
  const Ground ground(kerb);
  const auto z = [&](double x, double y, double most = 0.05) { return ground.at({x, y}, most, 0.1).z; };
  EXPECT_EQ(z(0.5, 0.5), 0.04) << "on top";
  EXPECT_EQ(z(0.5, 1.0), 0.04) << "above its side";
  EXPECT_EQ(z(1.05, 0.5), 0.04) << "above its end";
  EXPECT_NEAR(z(0.5, 1.06), 0.02, 1e-15) << "0.1 m from 6 cm aside: 8 cm above the edge";
  EXPECT_NEAR(z(1.11, 0.5), 0.02, 1e-12) << "at the end";
  EXPECT_NEAR(z(1.05 + 0.036, 1.0 + 0.048), 0.02, 1e-12) << "at a corner";
  EXPECT_NEAR(z(0.5, 1.0799), 0.04 - 0.1 + std::sqrt(0.01 - 0.0799 * 0.0799), 1e-12);
  EXPECT_EQ(z(0.5, 1.081), 0.0) << "the floor is higher than the arc";
  EXPECT_EQ(z(0.5, 1.06, 0.03), 0.0) << "too high";
  EXPECT_EQ(ground.at({0.5, 1.06}, 0.05).z, 0.0) << "points meet a step";
  const GroundPoint side = ground.at({0.5, 1.06}, 0.05, 0.1);
  EXPECT_NEAR(side.slope.y, -0.75, 1e-12);
  EXPECT_EQ(side.slope.x, 0.0);
  const std::vector<Ramp> ramp{{{0, 0}, {1, 0}, 0.0, 0.04, 1.0}};
  EXPECT_NEAR(Ground(ramp).at({0.75, 1.06}, 0.05, 0.1).slope.x, 0.04, 1e-15) << "along its side, a ramp rises";
}

TEST(Ground, WheelsRollOverTheBorderOfTheTerrain) {
  for (const float height : {0.04f, -0.04f}) {  // up to the terrain, and up to the floor
    const Terrain terrain{.cell = {2.0, 2.0}, .columns = 2, .rows = 2, .heights = std::vector(4, height)};
    const Ground ground({}, {&terrain, 1});
    const double top = std::max(height, 0.0f), out = height > 0.0f ? 1.0 : -1.0;
    const GroundPoint side = ground.at({1.0 + 0.06 * out, 0.5}, 0.05, 0.1);
    EXPECT_NEAR(side.z, top - 0.02, 1e-7);
    EXPECT_NEAR(side.slope.x, -0.75 * out, 1e-12);
    EXPECT_NEAR(ground.at({1.0 - 0.01 * out, 0.5}, 0.05, 0.1).z, top, 1e-7);
    EXPECT_NEAR(ground.at({1.0 + 0.11 * out, 0.5}, 0.05, 0.1).z, top - 0.04, 1e-7) << "beyond the wheel";
    EXPECT_NEAR(ground.at({1.0 + 0.06 * out, 0.5}, top - 0.01, 0.1).z, top - 0.04, 1e-7) << "too high";
  }
}

/// Points in a plateau 3 m high, 2 m by 2 m, of a body in front of it.
TEST(Ground, BodiesMeetTheFacesOfCliffs) {
  const Terrain terrain{.cell = {2.0, 2.0}, .columns = 2, .rows = 2, .heights = std::vector(4, 3.0f)};
  const Ground ground({}, {&terrain, 1});
  const GroundPoint face = ground.contact({-0.8, 0.3, 1.0}, {-5.0, 0.3}, 0.1);
  EXPECT_NEAR((face.z - 1.0) / glm::length(face.slope), 0.2, 1e-6) << "0.2 m behind the border";
  EXPECT_NEAR(face.slope.y, 0.0, 1e-3 * face.slope.x);
  EXPECT_GT(face.slope.x, 100.0) << "it rises away from the body";
  EXPECT_EQ(ground.contact({-0.8, 0.3, 2.95}, {-5.0, 0.3}, 0.1).z, 3.0) << "a step";
  EXPECT_NEAR(ground.contact({-0.8, 0.3, 1.0}, {-0.4, 0.3}, 0.1).slope.x, 1e3, 1.0) << "of a body that leans over it";
  EXPECT_EQ(ground.contact({-0.8, 0.3, 1.0}, {-0.7, 0.3}, 0.1).z, 3.0) << "of a body in the ground";
  EXPECT_EQ(ground.contact({-1.2, 0.3, 1.0}, {-5.0, 0.3}, 0.1).z, 0.0) << "in front of it";
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
