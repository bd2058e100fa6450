#include "robots/footprint.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/robots/scenes.h"

namespace sf::robots {
namespace {

using base::Pose;

// Outlines of squares of edge 0.4 m at given poses.
struct Square {
  explicit Square(const Pose& X_WM, double edge = 0.4, double height = 0.1) {
    world::World world = scenes::empty_world();
    world::Mover& mover = scenes::add_mover(world, X_WM, scenes::rectangle({}, edge, edge));
    for (world::Segment& s : mover.body) s.z_max = height;
    outline = footprint_of(mover);
    memory.resize(outline.edges.size());
    placed = place_footprint(outline, X_WM, memory);
  }
  Footprint outline;
  std::vector<FootprintEdge> memory;
  PlacedFootprint placed;
};

bool touches_wall(const Square& square, glm::dvec2 a, glm::dvec2 b, double z_min = 0.0, double z_max = 1.0) {
  return touches(square.placed, {.a = a, .b = b, .z_min = z_min, .z_max = z_max});
}

TEST(Footprint, WallCaseByCase) {
  const Square square({1, 1, 0, 0});
  EXPECT_TRUE(touches_wall(square, {1.1, 0}, {1.1, 3})) << "straight through";
  EXPECT_TRUE(touches_wall(square, {1.2, 0}, {1.2, 3})) << "along the front: touching counts";
  EXPECT_FALSE(touches_wall(square, {1.2001, 0}, {1.2001, 3})) << "just ahead";
  EXPECT_TRUE(touches_wall(square, {0.99, 1}, {1.01, 1})) << "a splinter wholly inside";
  EXPECT_FALSE(touches_wall(square, {1.25, 1.0}, {1.25, 1.1})) << "within the circle, ahead of the front";
  EXPECT_TRUE(touches_wall(square, {1.15, 1.15}, {3, 3})) << "a wall's end inside";
}

TEST(Footprint, Heights) {
  const Square square({0, 0, 0.5, 0});  // at z = 0.5, 0.1 m high
  EXPECT_FALSE(touches_wall(square, {0, -1}, {0, 1}, 0.6, 1)) << "a bridge exactly above";
  EXPECT_TRUE(touches_wall(square, {0, -1}, {0, 1}, 0.59, 1));
  EXPECT_FALSE(touches_wall(square, {0, -1}, {0, 1}, 0, 0.5)) << "a kerb exactly below";
  EXPECT_TRUE(touches_wall(square, {0, -1}, {0, 1}, 0, 0.51));
}

TEST(Footprint, Turns) {
  EXPECT_FALSE(touches_wall(Square({0, 0, 0, 0}), {0.25, -1}, {0.25, 1}));
  EXPECT_TRUE(touches_wall(Square({0, 0, 0, M_PI / 4}), {0.25, -1}, {0.25, 1})) << "the corner reaches 0.283 m";
}

TEST(Footprint, PairsCaseByCase) {
  const Square square({0, 0, 0, 0});
  EXPECT_TRUE(touches(square.placed, Square({0.3, 0.1, 0, 1}).placed)) << "crossing";
  EXPECT_FALSE(touches(square.placed, Square({0.41, 0, 0, 0}).placed)) << "side by side";
  EXPECT_FALSE(touches(square.placed, Square({0.41, 0.39, 0, 0}).placed)) << "circles overlap, squares do not";
  EXPECT_TRUE(touches(square.placed, Square({0, 0, 0, 0}, 0.1).placed)) << "the other inside";
  EXPECT_TRUE(touches(Square({0, 0, 0, 0}, 0.1).placed, square.placed)) << "inside the other";
  EXPECT_TRUE(touches(square.placed, Square({0, 0, 0, 0}).placed)) << "the very same place";
  EXPECT_FALSE(touches(square.placed, Square({0, 0, 0.1, 0}).placed)) << "one on top of the other";
}

TEST(Footprint, IsTheSame100KmAway) {
  EXPECT_TRUE(touches_wall(Square({1e5, 1e5, 0, 0}), {1e5 + 0.2 - 1e-9, 1e5 - 1}, {1e5 + 0.2 - 1e-9, 1e5 + 1}));
  EXPECT_FALSE(touches_wall(Square({1e5, 1e5, 0, 0}), {1e5 + 0.2 + 1e-9, 1e5 - 1}, {1e5 + 0.2 + 1e-9, 1e5 + 1}));
}

TEST(Footprint, StepIsAQuarterOfTheInradius) {
  world::World world = scenes::empty_world();
  world::Mover mover = scenes::add_square(world, {});
  EXPECT_DOUBLE_EQ(footprint_of(mover).step, 0.05);
  scenes::add_outline(mover.body, scenes::rectangle({0.1, 0}, 0.02, 0.02), 0.1, 0.2);
  EXPECT_DOUBLE_EQ(footprint_of(mover).step, 0.05) << "a small part carried on top does not shorten it";
  for (world::Segment& s : mover.body) s.a = s.a + glm::dvec2{1, 0}, s.b = s.b + glm::dvec2{1, 0};
  EXPECT_NEAR(footprint_of(mover).step, std::hypot(1.2, 0.2) / 16, 1e-12) << "the origin is outside";
}

TEST(Footprint, EdgesThatStopNoRobotAreOmitted) {
  world::World world = scenes::empty_world();
  world::Mover mover = scenes::add_square(world, {});
  for (world::Segment& s : mover.body) s.stops_robots = false;
  EXPECT_TRUE(footprint_of(mover).edges.empty());
  EXPECT_GT(footprint_of(mover).step, 0.0);
}

}  // namespace
}  // namespace sf::robots
