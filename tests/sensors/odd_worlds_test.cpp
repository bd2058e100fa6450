// Degenerate worlds.

#include <gtest/gtest.h>

#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

void add_wall(world::World& world, glm::dvec2 a, glm::dvec2 b) {
  scenes::add_outline(world, {a, b}, "wall" + std::to_string(world.models.size()));
  world.walls.pop_back();
  world.walls.back().solid_left = false;
}

/// Eyes everywhere, at random and aimed at every end of every segment.
void look_at_everything(world::World& world, double half, double range, std::uint64_t seed) {
  Chance chance(seed);
  const std::vector<world::Segment> walls = world.walls;
  for (int i = 0; i < 12; ++i) {
    const glm::dvec2 p = chance.in_square(half);
    add_eye(world, {p.x, p.y, 0.0, chance.between(-4.0, 4.0)}, eye(90, 2.0 * M_PI, range));
    for (const world::Segment& s : walls) {
      aim(world, p, s.a, eye(5, 1e-9, range));
      aim(world, p, 0.5 * (s.a + s.b), eye(5, 1e-9, range));
    }
  }
}

TEST(OddWorlds, NoWalls) {
  world::World world;
  add_eye(world, {1, 2, 0, 3}, eye(361, 2.0 * M_PI, 8.0));
  const Glance run(world);
  ASSERT_EQ(run.readings.size(), 1u);
  for (const double range : run.readings[0].values) EXPECT_EQ(range, 8.0);
  for (const std::uint32_t hit : run.readings[0].hits) EXPECT_EQ(hit, base::kNoHit);
}

TEST(OddWorlds, NoRobots) {
  const world::World world = scenes::boxes(3, 5.0, 1);
  EXPECT_TRUE(Glance(world).readings.empty());
}

TEST(OddWorlds, OneSegment) {
  world::World world;
  add_wall(world, {1, -1}, {1, 1});
  look_at_everything(world, 3.0, 8.0, 1);
  expect_exact("one segment", sweep(world));
}

/// One wall ends at the middle of another, one crosses it, three meet in a point.
TEST(OddWorlds, JunctionsAndCrossings) {
  for (const double yaw : {0.0, 0.4}) {
    world::World world;
    const auto wall = [&](glm::dvec2 a, glm::dvec2 b) { add_wall(world, base::rotate(yaw, a), base::rotate(yaw, b)); };
    wall({-2, 0}, {2, 0});
    wall({0.7, 0}, {0.7, 1.5});
    wall({-1, -1}, {-0.5, 1.1});
    wall({-0.3, 2}, {1.9, 2});
    wall({-0.3, 2}, {0.5, 3});
    wall({-0.3, 2}, {-2, 2.3});
    wall({-0.3, 2}, {1.9, 2.001});
    look_at_everything(world, 4.0, 8.0, 2);
    expect_exact("junctions and crossings", sweep(world));
  }
}

/// Two boxes share a wall; a third has the outline of the first; a fourth overlaps it along part of a wall.
TEST(OddWorlds, CoincidentSegments) {
  world::World world;
  scenes::add_outline(world, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, "first");
  scenes::add_outline(world, {{1, 0}, {2, 0}, {2, 1}, {1, 1}}, "adjacent");
  scenes::add_outline(world, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, "again");
  scenes::add_outline(world, {{0.25, 1}, {0.75, 1}, {0.75, 2}, {0.25, 2}}, "on top");
  add_wall(world, {-1, 1}, {3, 1});
  look_at_everything(world, 3.0, 8.0, 3);
  expect_exact("coincident segments", sweep(world));
}

/// Among coincident surfaces, the first in the world's table is reported, in any order of lists.
TEST(OddWorlds, ReportsTheFirstOfCoincidentSurfaces) {
  world::World world;
  scenes::add_outline(world, {{1, -1}, {2, -1}, {2, 1}, {1, 1}}, "first");
  scenes::add_outline(world, {{1, -1}, {2, -1}, {2, 1}, {1, 1}}, "second");
  add_eye(world, {}, eye(41, 0.5, 8.0));
  const Glance run(world);
  for (const std::uint32_t hit : run.readings[0].hits) EXPECT_EQ(hit, world.walls[0].model);
}

/// Nanometres next to a hundred kilometres.
TEST(OddWorlds, TinyAndHugeSegments) {
  for (const double range : {0.75, 100.0}) {
    world::World world;
    Chance chance(6);
    for (const double size : {1e-9, 1e-7, 1e-6, 1e-5, 1e-3, 1.0})
      for (int i = 0; i < 5; ++i) {
        const glm::dvec2 p = chance.in_square(0.5 * range);
        add_wall(world, p, p + size * chance.in_square(1.0));
      }
    add_wall(world, {-1e5, 0.31 * range}, {1e5, 0.33 * range});
    add_wall(world, {0.4 * range, -3e4}, {0.41 * range, 1e5});
    look_at_everything(world, 0.5 * range, range, 7);
    const Tally tally = sweep(world);
    expect_exact("tiny and huge segments, " + std::to_string(range) + " m", tally);
  }
}

/// A curve of a thousand chords, each shorter than a millimetre: neighbours differ by less than 15 degrees.
TEST(OddWorlds, RoundPillarOfManyChords) {
  world::World world;
  std::vector<glm::dvec2> corners;
  for (int i = 0; i < 1000; ++i) corners.push_back(base::rotate(i * 2.0 * M_PI / 1000, {0.1, 0.0}));
  scenes::add_outline(world, corners, "pillar");
  Chance chance(8);
  for (int i = 0; i < 60; ++i) {
    const glm::dvec2 p = chance.in_square(1.0);
    aim(world, p, corners[chance.below(1000)], eye(9, 1e-3, 8.0));
    aim(world, p, {}, eye(61, 0.5, 8.0));
  }
  expect_exact("a pillar of 1000 chords", sweep(world));
}

/// The widest gap that a 32-bit search could wrongly close: two walls with a slit between them.
TEST(OddWorlds, BeamsPassASlitOfTwentyMicrometres) {
  world::World world;
  add_wall(world, {5, -2}, {5, -1e-5});
  add_wall(world, {5, 1e-5}, {5, 2});
  add_wall(world, {7, -1}, {7, 1});
  for (const double far : {0.0, 1e5}) {
    world::World moved = world;
    add_eye(moved, {}, eye(1, 0.0, 8.0));
    world::translate(moved, far, far);
    EXPECT_NEAR(Glance(moved).readings[0].values[0], 7.0, 1e-9);
  }
}

}  // namespace
}  // namespace sf::trial
