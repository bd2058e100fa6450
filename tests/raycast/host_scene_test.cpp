// Compares host scans with 64-bit intersection with all segments: patterns, instruction sets, full caches.

#include "raycast/host_scene.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "tests/raycast/host_scan.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/scenes.h"

namespace sf::raycast {
namespace {

world::World crowd() {
  world::World world = scenes::boxes(40, 16.0, 2);
  scenes::add_robots(world, 60, scenes::laser(), 2);
  return world;
}

void expect_decided(const world::World& world, const ScanPattern& pattern, double range) {
  for (std::uint32_t m = 0; m < 12; ++m) {
    Pose X = world.movers[m].X_WM;
    X.z = 0.1;
    EXPECT_EQ(scan(world, X, m, pattern, range), intersect_everything(world, X, m, pattern, range)) << m;
  }
}

TEST(HostScene, AllFieldsOfViewAreExact) {
  const world::World world = crowd();
  for (const double fov : {0.0, 1e-7, 0.1, 0.5 * M_PI, M_PI, 1.5 * M_PI, 2.0 * M_PI})
    for (const std::size_t beams : {1, 2, 15, 16, 17, 64, 65, 361})
      expect_decided(world, pattern_of(even_bearings(beams, fov)), 8.0);
}

/// Irregular beams: a smaller last step, angular noise, many beams in one direction, unordered beams.
TEST(HostScene, IrregularBeamsAreExact) {
  const world::World world = crowd();
  trial::Chance chance(3);
  std::vector<double> short_last = even_bearings(46, M_PI);
  short_last.back() -= 0.06;
  expect_decided(world, pattern_of(short_last), 8.0);
  for (const double turn : {1e-4, 0.01, 0.3}) {
    std::vector<double> turned = even_bearings(181, 2.0 * M_PI);
    ScanPattern pattern;
    std::vector<double> directions;
    for (double& b : turned) {
      b += chance.between(-turn, turn);
      directions.insert(directions.end(), {std::cos(b), std::sin(b)});
    }
    pattern.assign(turned, directions, -M_PI, M_PI);
    EXPECT_GT(pattern.slack, 0.0f);
    expect_decided(world, pattern, 8.0);
  }
}

TEST(HostScene, InstructionSetsAreBitIdentical) {
  const world::World world = crowd();
  const ScanPattern pattern = pattern_of(even_bearings(361, M_PI));
  Pose X = world.movers[0].X_WM;
  X.z = 0.1;
  const Scan expected = scan(world, X, 0, pattern, 8.0);
  const std::int64_t all = hwy::SupportedTargets();
  int tried = 0;
  for (std::int64_t left = all; left != 0; left &= left - 1) {
    hwy::SetSupportedTargetsForTest(left & -left);
    hwy::GetChosenTarget().DeInit();  // reselected by the next call
    EXPECT_EQ(scan(world, X, 0, pattern, 8.0), expected) << vector_instructions();
    ++tried;
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  EXPECT_GE(tried, 2) << "the fallback and at least one other";
}

TEST(HostScene, BuildsEachCellOnce) {
  const world::World world = crowd();
  base::ThreadPool thread_pool(2);
  ListConfigs configs(world);
  const std::uint32_t config = configs.add({0.1, 8.0, 0.0, M_PI});
  EXPECT_EQ(configs.add({0.1, 8.0, 0.0, 0.1}), config) << "one height, one range";
  EXPECT_NE(configs.add({0.1, 4.0, 0.0, M_PI}), config);
  HostScene scene(world, configs, thread_pool);
  const Viewpoint views[] = {
      {config, 0, {0.1, 0.1, 0.1, 0.0}}, {config, 1, {0.9, 0.9, 0.1, 1.0}}, {config, 2, {1.1, 0.1, 0.1, 0.0}}};
  const std::vector<base::Report> states = robots::states_at_load(world);
  scene.place_movers(states);
  scene.prepare(views);
  EXPECT_EQ(scene.cells_built(), 2u) << "cells of a metre at 8 m";
  scene.prepare(views);
  EXPECT_EQ(scene.cells_built(), 2u);
}

/// Viewpoints inside and outside of solids share cells, over several ticks.
TEST(HostScene, CellsWithViewsOnBothSidesOfWalls) {
  const world::World world = crowd();
  base::ThreadPool thread_pool(2);
  ListConfigs configs(world);
  const std::uint32_t config = configs.add({0.1, 8.0, 0.0, 2.0 * M_PI});
  HostScene scene(world, configs, thread_pool);
  const std::vector<base::Report> states = robots::states_at_load(world);
  scene.place_movers(states);
  const ScanPattern pattern = pattern_of(even_bearings(5, M_PI));
  trial::Chance chance(7);
  for (int tick = 0; tick < 4; ++tick) {
    std::vector<Viewpoint> views;
    for (int i = 0; i < 400; ++i) {
      const glm::dvec2 p = chance.in_square(2.0);
      views.push_back({config, 0, {p.x, p.y, 0.1, 0.0}, {1.0, 0.0}});
    }
    scene.prepare(views);
    for (std::size_t i = 0; i < views.size(); ++i) {
      Scan given{std::vector<double>(5), std::vector<std::uint32_t>(5)};
      std::vector<std::uint8_t> grazes(5);
      scene.scan(i, {.heading = {1.0, 0.0}, .min_sine = 1e-3}, pattern, 0,
                 {given.ranges.data(), given.models.data(), grazes.data()});
      EXPECT_EQ(given, intersect_everything(world, views[i].X_WS, 0, pattern, 8.0)) << tick << " " << i;
    }
  }
}

/// Five hundred robots return to more cells than the cache has initially, so it grows to keep them. For a single robot
/// it does not grow as much.
TEST(HostScene, KeepsCellsThatAreVisitedAgain) {
  const world::World world = scenes::boxes(400, 40.0, 2);
  base::ThreadPool thread_pool(1);
  ListConfigs configs(world);
  const std::uint32_t config = configs.add({0.1, 2.0, 0.0, M_PI});
  for (const std::size_t robots : {1, 500}) {
    HostScene scene(world, configs, thread_pool);
    std::uint64_t built[4] = {};
    for (std::uint64_t& total : built) {
      for (int cell = 0; cell < 40 * 40; ++cell) {
        const Viewpoint view{config, 0, {-20.0 + cell % 40, -20.0 + cell / 40, 0.1, 0.0}};
        scene.prepare(std::vector<Viewpoint>(robots, view));
      }
      total = scene.cells_built();
    }
    EXPECT_GT(built[0], 1'000u);
    EXPECT_EQ(built[3] == built[2], robots > 1) << robots;
  }
}

TEST(MoverGeometry, MoversOfEqualShapeShareBlocks) {
  world::World world;
  for (int i = 0; i < 5; ++i) scenes::add_robot(world, {2.0 * i, 0.0, 0.0, 0.3 * i}, scenes::laser());
  MoverGeometry movers(world);
  const OutlineTable& outlines = movers.outlines();
  EXPECT_EQ(outlines.blocks.size(), 2u) << "16 edges outward, 16 inward";
  EXPECT_EQ(outlines.of_mover[4].first, outlines.of_mover[0].first);
  EXPECT_EQ(outlines.at(0, 0.1).all, 2u);
  EXPECT_EQ(outlines.at(0, 100.0).all, 0u) << "nothing so high";
  EXPECT_EQ(outlines.at(0, -0.1).all, 0u) << "nothing so low";
}

/// An absent mover is not in any cell. The others are in their cells.
TEST(MoverGeometry, AbsentMoversAreNotInTheGrid) {
  world::World world;
  for (int i = 0; i < 3; ++i) scenes::add_robot(world, {5.0 * i, 0.0, 0.0, 0.0}, scenes::laser());
  MoverGeometry movers(world);
  base::ThreadPool thread_pool(1);
  std::vector<ExactSegment> exact(movers.segments());
  std::vector<base::Report> states = robots::states_at_load(world);
  states[1].X_WM = base::kAbsent;
  movers.place(states, thread_pool, exact);
  EXPECT_EQ(movers.grid().first.back(), 2u);
  EXPECT_EQ(movers.grid().low.x, 0.0);
  for (base::Report& state : states) state.X_WM = base::kAbsent;
  movers.place(states, thread_pool, exact);
  EXPECT_EQ(movers.grid().first.back(), 0u) << "all of them";
}

}  // namespace
}  // namespace sf::raycast
