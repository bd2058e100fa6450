// Queries of the wall index whose results are known.

#include "raycast/wall_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sensors/chance.h"
#include "tests/sensors/scenes.h"
#include "world/wall_tree.h"

namespace sf::raycast {
namespace {

TEST(WallIndex, FindsAllWallsNearAPoint) {
  const world::World world = scenes::boxes(60, 16.0, 5);
  const WallIndex wall_index(world.walls);
  std::vector<std::uint32_t> found;
  trial::Chance chance(3);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec2 p = chance.in_square(10.0);
    const double radius = chance.between(0.01, 5.0);
    wall_index.near(p, 0.1, radius, found);
    for (std::uint32_t k = 0; k < wall_index.segments().size(); ++k) {
      const bool near = world::distance(p, wall_index.segments()[k].a, wall_index.segments()[k].b) <= radius;
      const auto times = std::count(found.begin(), found.end(), k);
      EXPECT_TRUE(times == 1 || (times == 0 && !near));
    }
  }
}

TEST(WallIndex, DetectsPointsInsideSolids) {
  world::World world;
  scenes::add_room(world, {}, 10.0);
  scenes::add_outline(world, {{0, 0}, {2, 0}, {2, 2}, {0, 2}}, "box");
  scenes::add_outline(world, {{1, 1}, {3, 1}, {3, 3}, {1, 3}}, "overlapping");
  const WallIndex wall_index(world.walls);
  EXPECT_TRUE(wall_index.inside_solid({0.5, 0.5}, 0.1));
  EXPECT_TRUE(wall_index.inside_solid({1.5, 1.5}, 0.1)) << "in both";
  EXPECT_TRUE(wall_index.inside_solid({5.05, 0.0}, 0.1)) << "in the ring of the room";
  EXPECT_FALSE(wall_index.inside_solid({-1.0, 0.0}, 0.1)) << "in the room";
  EXPECT_FALSE(wall_index.inside_solid({2.5, 0.5}, 0.1));
  EXPECT_FALSE(wall_index.inside_solid({6.0, 0.0}, 0.1)) << "out of the room";
  EXPECT_FALSE(wall_index.inside_solid({1e9, -1e9}, 0.1));
  EXPECT_FALSE(WallIndex(std::span<const world::Segment>()).inside_solid({0, 0}, 0.1)) << "no walls";
}

/// Walls as long as the world are in every band, so there must be few bands; short ones ask for many.
TEST(WallIndex, DetectsPointsBetweenLongSlats) {
  world::World world;
  for (int k = 0; k < 400; ++k) {
    const double x = 2.0 * k, y = k % 2 == 0 ? -50.0 : 0.25 * k - 50.0, height = k % 2 == 0 ? 100.0 : 0.2;
    scenes::add_outline(world, {{x, y}, {x + 1.0, y}, {x + 1.0, y + height}, {x, y + height}}, "slat");
  }
  const WallIndex wall_index(world.walls);
  for (int k = 0; k < 400; ++k)
    for (const double y : {-49.9, -0.1, 0.25 * k - 49.9, 49.9}) {
      EXPECT_EQ(wall_index.inside_solid({2.0 * k + 0.5, y}, 0.1), k % 2 == 0 || std::abs(y - (0.25 * k - 49.9)) < 0.1);
      EXPECT_FALSE(wall_index.inside_solid({2.0 * k + 1.5, y}, 0.1));
    }
}

}  // namespace
}  // namespace sf::raycast
