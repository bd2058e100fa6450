// Cliff sensors: points over floor holes, decided exactly.

#include "sensors/cliff.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sensors/host_trial.h"

namespace sf::trial {
namespace {

using sensors::holds;

world::Sensor four_points() {
  return fitted("cliff",
                {setting("scount", {4}), setting("spose[0]", {0.1, 0.1, 0}), setting("spose[1]", {0.1, -0.1, 0}),
                 setting("spose[2]", {-0.1, 0.1, 0}), setting("spose[3]", {-0.1, -0.1, 0})});
}

void add_drop(world::World& world, std::vector<glm::dvec2> outline) {
  world.floor_holes.push_back({std::move(outline), 0});
}

TEST(Cliff, ReadsOneOverADropInFileOrder) {
  world::World world = carriers(four_points());
  EXPECT_EQ(read_once(world), (std::vector<double>{0, 0, 0, 0})) << "a floor everywhere";
  add_drop(world, {{0.05, 0.0}, {5, 0.0}, {5, 5}, {0.05, 5}});
  EXPECT_EQ(read_once(world), (std::vector<double>{1, 0, 0, 0}));
  world.movers[0].X_WM.yaw = -M_PI / 2;
  EXPECT_EQ(read_once(world), (std::vector<double>{0, 0, 1, 0}))
      << "turned right, its rear left point is over the drop";
  add_drop(world, square({0, -0.5}, 0.9));
  EXPECT_EQ(read_once(world), (std::vector<double>{1, 1, 1, 0})) << "either drop counts";
}

TEST(Cliff, UsesTheSensorPose) {
  world::Sensor sensor = fitted("cliff");
  sensor.X_MS = {0.5, 0.25, 0, 0};
  world::World world = carriers(sensor, {{1, 1, 0, M_PI / 2}});
  add_drop(world, square({0.75, 1.5}, 0.01));
  EXPECT_EQ(read_once(world), std::vector<double>{1});
}

TEST(Cliff, HandlesEitherWindingAndAnyShape) {
  const std::vector<glm::dvec2> notch{{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}};
  const std::vector<glm::dvec2> reversed(notch.rbegin(), notch.rend());
  for (const auto& outline : {notch, reversed}) {
    EXPECT_TRUE(holds(outline, {0.5, 2}));
    EXPECT_TRUE(holds(outline, {2, 0.5}));
    EXPECT_FALSE(holds(outline, {2, 2})) << "in the notch";
    EXPECT_FALSE(holds(outline, {-1, 1}));
    EXPECT_FALSE(holds(outline, {5, 4})) << "level with a corner";
    EXPECT_FALSE(holds(outline, {-1, 4})) << "level with two corners";
    EXPECT_FALSE(holds(outline, {-1, 0})) << "level with an edge";
  }
  EXPECT_FALSE(holds({}, {0, 0}));
  EXPECT_FALSE(holds(std::vector<glm::dvec2>{{0, 0}, {1, 1}}, {0.5, 0.5})) << "two points have no inside";
}

/// A square split into a fan of triangles: every point, including points on shared edges, is in exactly one of them.
TEST(Cliff, PointsOnSharedEdgesAreInExactlyOneHole) {
  Chance chance(1);
  for (int round = 0; round < 50; ++round) {
    const double far = round % 2 == 0 ? 0.0 : 1e5;
    const glm::dvec2 hub{far + chance.between(-0.9, 0.9), chance.between(-0.9, 0.9) - far};
    const std::vector<glm::dvec2> rim = square({far, -far}, 2.0);
    const auto count = [&](glm::dvec2 p) {
      int held = 0;
      for (std::size_t i = 0; i < 4; ++i) held += holds(std::vector<glm::dvec2>{hub, rim[i], rim[(i + 1) % 4]}, p);
      return held;
    };
    for (const glm::dvec2& corner : rim)
      for (const double t : {0.25, 0.5, 0.75}) EXPECT_EQ(count(hub + t * (corner - hub)), 1);
    EXPECT_EQ(count(hub), 1);
    for (int i = 0; i < 20; ++i)
      EXPECT_EQ(count({far + chance.between(-0.99, 0.99), chance.between(-0.99, 0.99) - far}), 1);
  }
}

/// Compares the tree of boxes with a test of every hole.
TEST(Cliff, IndexMatchesATestOfEveryHole) {
  Chance chance(2);
  std::vector<world::FloorHole> drops;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec2 p = chance.in_square(10.0);
    std::vector<glm::dvec2> outline;
    for (int k = 0; k < 5; ++k)
      outline.push_back(p + base::rotate(2 * M_PI * k / 5, {chance.between(0.1, i % 10 == 0 ? 4.0 : 0.5), 0.0}));
    drops.push_back({outline, 0});
  }
  const sensors::DropOffIndex all(drops);
  int inside = 0;
  for (int i = 0; i < 5000; ++i) {
    const glm::dvec2 p = chance.in_square(11.0);
    const bool any = std::any_of(drops.begin(), drops.end(), [&](const auto& d) { return holds(d.outline, p); });
    inside += any;
    EXPECT_EQ(all.hold(p), any);
  }
  EXPECT_GT(inside, 500);
  EXPECT_LT(inside, 4500);
}

TEST(Cliff, RejectsInvalidSettings) {
  expect_refused("cliff", {setting("scount", {33})}, 8, "expected 1 to 32");
  expect_refused("cliff", {setting("scount", {2}), setting("spose[0]", {0, 0, 0})}, 8, "'spose[1]' is missing");
  expect_refused("cliff", {setting("spose[0]", {0, 0})}, 8, "[x y yaw]");
  expect_refused("cliff", {setting("spose[3]", {0, 0, 0})}, 8, "beyond 'scount 1'");
  expect_refused("cliff", {setting("rate", {0})}, 8, "'rate' is 0");
}

}  // namespace
}  // namespace sf::trial
