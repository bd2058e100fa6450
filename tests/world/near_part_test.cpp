#include "world/near_part.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sf::world {

namespace {

const base::Box kTile{{0, 0}, {10, 10}};

World with_walls(std::vector<Segment> walls) {
  World world;
  world.walls = std::move(walls);
  return world;
}

Segment thin(glm::dvec2 a, glm::dvec2 b, std::uint32_t model) {
  Segment wall{a, b};
  wall.model = model;
  wall.solid_left = false;
  return wall;
}

const Segment kLongest = thin({0, 0}, {9, 0}, 0);

std::size_t kept(std::vector<Segment> walls, double reach) {
  World world = with_walls(std::move(walls));
  keep_near(world, kTile, reach);
  return world.walls.size();
}

TEST(NearPart, WallAtTheReachIsKept) {
  EXPECT_EQ(kept({kLongest, thin({12, 0}, {13, 0}, 1)}, 2.0), 2u);
  EXPECT_EQ(kept({kLongest, thin({12, 0}, {13, 0}, 1)}, 1.9), 1u);
}

TEST(NearPart, OutlineIsKeptWhole) {  // whether a ray starts inside a solid depends on all of its edges
  const std::vector<glm::dvec2> corners{{9, 1}, {99, 1}, {99, 3}, {9, 3}};
  std::vector<Segment> walls{thin({0, 0}, {200, 0}, 0)};
  for (std::size_t i = 0; i < 4; ++i) {
    Segment wall{corners[i], corners[(i + 1) % 4]};
    wall.model = 1;
    walls.push_back(wall);
  }
  EXPECT_EQ(kept(walls, 1.0), 5u);
}

TEST(NearPart, OutlineInPiecesIsKept) {  // its other pieces may be anywhere
  Segment piece{{50, 50}, {51, 50}};
  piece.model = 1;
  EXPECT_EQ(kept({kLongest, piece}, 1.0), 2u);
}

TEST(NearPart, OneOfTheLongestWallsIsKept) {  // error bounds depend on its length
  EXPECT_EQ(kept({thin({50, 0}, {59, 0}, 0), thin({70, 0}, {79, 0}, 1), thin({50, 5}, {51, 5}, 2)}, 1.0), 1u);
}

TEST(NearPart, InfiniteTileKeepsEverything) {
  World world = with_walls({thin({1e6, 0}, {1e6, 1}, 0), thin({-1e6, 0}, {-1e6, 2}, 1)});
  keep_near(world, {{-HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL}}, 1.0);
  EXPECT_EQ(world.walls.size(), 2u);
}

TEST(NearPart, OtherTablesAreKept) {
  World world = with_walls({kLongest, thin({50, 0}, {51, 0}, 1)});
  world.models.resize(2);
  world.extent = {0, 0, 51, 0};
  world.hash = 7;
  keep_near(world, kTile, 1.0);
  EXPECT_EQ(world.models.size(), 2u);
  EXPECT_EQ(world.extent.x_max, 51);
  EXPECT_EQ(world.hash, 7u);
}

}  // namespace

}  // namespace sf::world
