// Measurement of all modes, and selection of modes.

#include "scenarios/tradeoff.h"
#include "tests/sensors/edit_laser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/device.h"
#include "tests/sensors/scenes.h"

namespace sf::scenarios {
namespace {

world::World small_world() {
  world::World world = scenes::boxes(20, 8.0, 3);
  scenes::add_robots(world, 4, scenes::laser(61, M_PI, 4.0), 5);
  world.magnets.push_back({{0.5, 0.5}, -0.04, 1.0, 0.01, 0});
  for (world::Mover& mover : world.movers) mover.sensors.push_back({"magnetometer", "m", {}, 0.1, 1.0, 1.0, {}, 0, ""});
  world::update_extent_and_hash(world);
  return world;
}

TEST(Tradeoff, MeasuresEveryModeOfEveryType) {
  const auto results = tradeoff(small_world(), device(), {});
  std::map<std::string, int> modes;
  for (const ModeResult& g : results) {
    ++modes[g.sensor];
    EXPECT_GT(g.rate, 0.0) << g.mode;
    EXPECT_LE(g.median, g.p99);
    EXPECT_LE(g.p99, g.max);
    EXPECT_LE(g.covered_max, g.bound) << g.sensor << " " << g.mode;
    EXPECT_LE(g.covered_max, g.max);
    EXPECT_TRUE(g.covered < 1.0 || g.mode == "exact" || g.covered_max == g.max)
        << "the largest of all, not the last one";
    EXPECT_TRUE(g.mode != "exact" || g.max == 0.0) << "lasers to the bit as plain C++ has them";
  }
  EXPECT_EQ(modes, (std::map<std::string, int>{{"laser", 5}, {"magnetometer", 4}}));
  EXPECT_EQ(results[0].unit, "m");
  EXPECT_EQ(results.back().unit, "T");
  EXPECT_NEAR(results[2].covered, 31.0 / 61.0, 0.01) << "every other beam of 61";
  EXPECT_GT(results[2].max, 1000.0 * results[2].bound) << "of all values: no bound covers omitted ones";
  EXPECT_EQ(results[0].covered, 1.0);
  EXPECT_GT(results[1].max, 0.0) << "32 bits show";
}

TEST(Tradeoff, CanBeStopped) {
  EXPECT_TRUE(tradeoff(small_world(), device(), {.progress = [](double) { return false; }}).empty());
}

/// A lane edge sensor in a bend: no bound covers its readings, and none is shown.
TEST(Tradeoff, NoBoundIsGivenIfNoneHolds) {
  world::World world;
  world::LaneMarking bend{{}, 0.1};
  for (int i = 0; i <= 600; ++i) bend.line.push_back(base::rotate(0.01 * i, {0.68, 0.0}));
  world.lane_markings.push_back(bend);
  scenes::add_robot(world, {0.3, 0.0, 0.0, 0.0}, scenes::laser(3));
  scenes::remove_lasers(world.movers[0]);
  world.movers[0].sensors.push_back({"laneedge", "e", {}, 0.01, 1.0, M_PI / 180.0, {}, 0, ""});
  world::update_extent_and_hash(world);
  for (const ModeResult& g : tradeoff(world, device(), {})) {
    EXPECT_EQ(g.sensor, "laneedge");
    EXPECT_EQ(g.covered, 0.0) << g.mode;
    EXPECT_TRUE(std::isinf(g.bound)) << g.mode;
  }
}

TEST(Tradeoff, WritesAFileOfColumns) {
  const std::string csv =
      csv_of({{.sensor = "laser", .mode = "skip2", .unit = "m", .rate = 1e6, .max = 7.0, .covered = 0.5, .bound = 1e-9},
              {.sensor = "laneedge", .mode = "skip2", .unit = "m", .rate = 1e3, .max = 0.5}});
  EXPECT_EQ(csv,
            "sensor,mode,rate_per_s,covered,covered_max_error,covered_bound,all_median_error,all_p99_error,"
            "all_max_error\n"
            "laser,skip2,1e+06,0.5,0,1e-09,0,0,7\n"
            "laneedge,skip2,1000,0,,,0,0,0.5\n");
}

std::vector<ModeResult> made_up() {
  return {{.sensor = "laser", .mode = "exact", .unit = "m", .rate = 10, .tick = 0.10},
          {.sensor = "laser", .mode = "single", .unit = "m", .rate = 20, .tick = 0.05, .p99 = 1e-4, .max = 1e-3},
          {.sensor = "laser", .mode = "skip2", .unit = "m", .rate = 40, .tick = 0.02, .p99 = 1e-3, .max = 1.0},
          {.sensor = "magnetometer", .mode = "exact", .unit = "T", .rate = 10, .tick = 0.10},
          {.sensor = "magnetometer", .mode = "near3", .unit = "T", .rate = 50, .tick = 0.02, .p99 = 1e-8, .max = 2e-7}};
}

std::string advised(const AccuracyTarget& target) { return accuracy_words(made_up(), select_modes(made_up(), target)); }

TEST(Advice, SelectsTheFastestWithinTheErrors) {
  EXPECT_EQ(advised({.metres = 5e-3, .tesla = 1e-9}), "laser:single");
  EXPECT_EQ(advised({.metres = 5e-3, .tesla = 1e-6}), "laser:single magnetometer:near3");
  EXPECT_EQ(advised({.metres = 5e-3, .tesla = 1e-6, .by = ErrorMeasure::p99}), "laser:skip2 magnetometer:near3");
  EXPECT_EQ(advised({.metres = 1e-9, .tesla = 1e-12}), "exact") << "which is always there";
  EXPECT_EQ(advised({.metres = 1e-3, .tesla = 1e-12}), "laser:single") << "the limit is inclusive";
}

/// Simplified meshes in a world without any: equal readings without a bound, and ticks that differ by chance.
TEST(Advice, IgnoresModesThatOnlyLoseTheBound) {
  const std::vector<ModeResult> results{
      {.sensor = "lidar", .mode = "exact", .unit = "m", .rate = 10, .tick = 0.10, .covered = 1.0},
      {.sensor = "lidar", .mode = "coarse1", .unit = "m", .rate = 11, .tick = 0.09}};
  EXPECT_EQ(accuracy_words(results, select_modes(results, {.metres = 1e-2})), "exact");
  EXPECT_EQ(accuracy_words(results, select_modes(results, {.least_rate = 10.5})), "exact");
}

/// Ticks add up over sensor types.
TEST(Advice, SelectsTheMostAccurateThatIsFastEnough) {
  EXPECT_EQ(advised({.least_rate = 4.0}), "exact") << "0.2 s";
  EXPECT_EQ(advised({.least_rate = 6.0}), "magnetometer:near3") << "one step like laser:single, and faster";
  EXPECT_EQ(advised({.least_rate = 8.0}), "magnetometer:near3") << "0.12 s";
  EXPECT_EQ(advised({.least_rate = 14.0}), "laser:single magnetometer:near3") << "0.07 s";
  EXPECT_EQ(advised({.least_rate = 1000.0}), "laser:skip2 magnetometer:near3") << "never: the fastest there is";
}

}  // namespace
}  // namespace sf::scenarios
