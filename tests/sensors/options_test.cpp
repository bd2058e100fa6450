// Effects of a laser's settings on its readings.

#include <gtest/gtest.h>

#include "raycast/beams.h"
#include "sensors/laser_settings.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

/// A single wall 2 m ahead.
world::World one_wall() {
  world::World world;
  scenes::add_outline(world, {{2, -50}, {3, -50}, {3, 50}, {2, 50}}, "wall");
  return world;
}

std::vector<double> read(const sensors::LaserSettings& laser) {
  world::World world = one_wall();
  add_eye(world, {}, laser);
  const Glance glance(world);
  return {glance.readings[0].values.begin(), glance.readings[0].values.end()};
}

TEST(Options, NearEchoesReadRangeMin) {
  sensors::LaserSettings laser = eye(3, 0.2, 8.0);
  laser.range_min = 2.005;
  const auto ranges = read(laser);
  EXPECT_NEAR(ranges[0], 2.0 / std::cos(0.1), 1e-12);
  EXPECT_EQ(ranges[1], 2.005);
}

TEST(Options, EchoesEndAtRangeMax) {
  EXPECT_EQ(read(eye(1, 0.0, std::nextafter(2.0, 0.0)))[0], std::nextafter(2.0, 0.0)) << "just short of the wall";
  EXPECT_EQ(read(eye(1, 0.0, 2.0))[0], 2.0) << "at the wall";
  world::World world = one_wall();
  add_eye(world, {}, eye(1, 0.0, std::nextafter(2.0, 3.0)));
  const Glance glance(world);
  EXPECT_EQ(glance.readings[0].values[0], 2.0) << "just beyond it";
  EXPECT_EQ(glance.readings[0].hits[0], world.walls[0].model);
}

/// Every n-th sample and the last are cast. The others are interpolated linearly.
TEST(Options, ResolutionCastsEveryNthBeam) {
  world::World world = one_wall();
  const sensors::LaserSettings fine = eye(10, 1.2, 8.0);
  sensors::LaserSettings coarse = fine;
  coarse.resolution = 4;
  add_eye(world, {}, fine);
  add_eye(world, {}, coarse);
  const Glance glance(world);
  const auto all = glance.readings[0].values;
  const auto some = glance.readings[1].values;
  ASSERT_EQ(some.size(), 10u);
  for (const std::size_t cast : {0u, 4u, 8u, 9u}) EXPECT_EQ(some[cast], all[cast]) << cast;
  for (const std::size_t between : {1u, 2u, 3u})
    EXPECT_NEAR(some[between], all[0] + (all[4] - all[0]) * static_cast<double>(between) / 4.0, 1e-12);
  EXPECT_NEAR(some[6], 0.5 * (all[4] + all[8]), 1e-12);
  EXPECT_EQ(glance.farm.stats().work.rays, 10u + 4u) << "beams left out cost nothing";
}

TEST(Options, InterpolatedBeamsReportTheModelOfBothNeighbours) {
  world::World world;
  scenes::add_outline(world, {{2, -50}, {3, -50}, {3, 0.001}, {2, 0.001}}, "right half");
  sensors::LaserSettings laser = eye(9, 1.2, 8.0);
  laser.resolution = 4;
  add_eye(world, {}, laser);
  const Glance glance(world);
  const auto hits = glance.readings[0].hits;
  for (const std::size_t i : {0u, 1u, 2u, 3u, 4u}) EXPECT_EQ(hits[i], world.walls[0].model) << i;
  for (const std::size_t i : {5u, 6u, 7u, 8u}) EXPECT_EQ(hits[i], base::kNoHit) << i;
}

TEST(Options, ResolutionBeyondTheSamplesCastsBothEnds) {
  sensors::LaserSettings laser = eye(9, 1.2, 8.0);
  laser.resolution = 1000;
  const raycast::BeamPlan plan = raycast::plan_beams(laser, false);
  EXPECT_EQ(plan.samples, (std::vector<std::uint32_t>{0, 8}));
  const auto ranges = read(laser);
  for (const double range : ranges) EXPECT_NEAR(range, 2.0 / std::cos(0.6), 1e-12);
}

/// Bearings: both ends are exact, the middle is 0, mirrored bit by bit. Four beams share a lane until they spread too
/// far.
TEST(Options, BearingsAndLanes) {
  const sensors::LaserSettings fan = eye(361, M_PI, 8.0);
  EXPECT_EQ(bearing_of(fan, 0), -M_PI / 2);
  EXPECT_EQ(bearing_of(fan, 360), M_PI / 2);
  EXPECT_EQ(bearing_of(fan, 180), 0.0);
  for (std::uint32_t i = 0; i < 361; ++i) EXPECT_EQ(bearing_of(fan, i), -bearing_of(fan, 360 - i)) << i;
  EXPECT_EQ(bearing_of(eye(1, 3.0, 8.0), 0), 0.0);

  EXPECT_TRUE(raycast::plan_beams(fan, false).packed);
  EXPECT_EQ(raycast::plan_beams(fan, false).lanes(), 91u);
  const raycast::BeamPlan wide = raycast::plan_beams(eye(16, 2.0 * M_PI, 8.0), false);
  EXPECT_FALSE(wide.packed) << "24 degrees apart";
  EXPECT_EQ(wide.lanes(), 16u);
  sensors::LaserSettings noisy = fan;
  noisy.noise.angle_sigma = 0.05;
  EXPECT_FALSE(raycast::plan_beams(noisy, true).packed) << "noise may turn beams of a lane far apart";
  EXPECT_TRUE(raycast::plan_beams(noisy, false).packed);
}

/// Unused places of a lane repeat its last beam.
TEST(Options, LastLaneIsPadded) {
  const sensors::LaserSettings laser = eye(5, 0.2, 8.0);
  const raycast::BeamPlan plan = raycast::plan_beams(laser, false);
  ASSERT_EQ(plan.lanes(), 2u);
  std::vector<float> middles(2);
  std::vector<double> directions64(16);
  write_beams(laser, plan, {}, {middles.data(), directions64.data()});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(directions64[8 + 2 * i], std::cos(0.1));
    EXPECT_EQ(directions64[8 + 2 * i + 1], std::sin(0.1));
  }
  EXPECT_NEAR(middles[1], 0.1 * SF_SECTORS / (2.0 * M_PI), 1e-6);
}

}  // namespace
}  // namespace sf::trial
