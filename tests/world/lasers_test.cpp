#include "world/stage/laser_entities.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/world/read_world.h"

namespace sf::world {
namespace {

constexpr double kDegree = M_PI / 180.0;

std::vector<Laser> lasers(const std::string& inside, const LoadOptions& options = {}) {
  return read_world("position( size [0.4 0.4 0.1] " + inside + " )", options).movers.at(0).lasers;
}

TEST(Lasers, TheOlderDialect) {
  const auto all = lasers(
      "laser( fov 90 samples 31 range_min 0.1 range_max 4 resolution 3 laser_color \"green\" pose [0.1 0.2 -0.025 30]"
      " size [0.1 0.1 0.19] )");
  ASSERT_EQ(all.size(), 1u);
  const Laser& laser = all[0];
  EXPECT_DOUBLE_EQ(laser.fov, 90 * kDegree);
  EXPECT_EQ(laser.samples, 31u);
  EXPECT_EQ(laser.range_min, 0.1);
  EXPECT_EQ(laser.range_max, 4.0);
  EXPECT_EQ(laser.resolution, 3u);
  EXPECT_EQ(laser.color, 0xFF00FF00u);
  EXPECT_EQ(laser.X_MS.x, 0.1);
  EXPECT_DOUBLE_EQ(laser.X_MS.yaw, 30 * kDegree);
  EXPECT_NEAR(laser.X_MS.z, 0.1 - 0.025 + 0.095, 1e-15);  // on the robot, at half the height of the laser
  EXPECT_EQ(laser.name, "laser:0");
}

TEST(Lasers, TheOlderDialectsDefaults) {
  const Laser laser = lasers("laser()").at(0);
  EXPECT_EQ(laser.samples, 180u);
  EXPECT_DOUBLE_EQ(laser.fov, M_PI);
  EXPECT_EQ(laser.range_max, 8.0);
  EXPECT_EQ(laser.rate, 10.0);
  EXPECT_EQ(laser.resolution, 1u);
  EXPECT_DOUBLE_EQ(laser.X_MS.z, 0.2);
}

TEST(Lasers, TheNewerDialectIsOneLaserPerSensorInFileOrder) {
  const auto all = lasers(
      "ranger( pose [0.1 0 0 90] origin [0 0 0.3 0] sensor( pose [0.2 0 0.1 10] range [0.5 3] fov 20 samples 7 ) "
      "sensor() )");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_NEAR(all[0].X_MS.x, 0.1, 1e-15);
  EXPECT_DOUBLE_EQ(all[0].X_MS.y, 0.2);
  EXPECT_DOUBLE_EQ(all[0].X_MS.yaw, 100 * kDegree);
  EXPECT_NEAR(all[0].X_MS.z, 0.1 + 0.3 + 0.1 + 0.01, 1e-15);
  EXPECT_EQ(all[0].range_min, 0.5);
  EXPECT_EQ(all[0].range_max, 3.0);
  EXPECT_EQ(all[0].samples, 7u);
  EXPECT_EQ(all[0].name, "ranger:0[0]");
  EXPECT_EQ(all[1].samples, 1u);
  EXPECT_EQ(all[1].range_max, 5.0);
  EXPECT_EQ(all[1].fov, 0.1);
}

TEST(Lasers, TheArrayOfTheOlderDialect) {
  const auto all = lasers("ranger( scount 2 sview [0.1 2 30] spose[1] [0.1 -0.1 -45] spose[0] [0.1 0.1 45] )");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_DOUBLE_EQ(all[0].X_MS.yaw, 45 * kDegree);
  EXPECT_DOUBLE_EQ(all[1].X_MS.yaw, -45 * kDegree);
  EXPECT_EQ(all[1].range_min, 0.1);
  EXPECT_EQ(all[1].range_max, 2.0);
  EXPECT_DOUBLE_EQ(all[1].fov, 30 * kDegree);
  EXPECT_EQ(all[1].samples, 1u);
}

TEST(Lasers, TheOldViewOfASensorIsItsRangeAndField) {
  const Laser laser = lasers("ranger( sensor( size [0.01 0.04] view [0.1 5 30] ) )").at(0);
  EXPECT_EQ(laser.range_min, 0.1);
  EXPECT_DOUBLE_EQ(laser.fov, 30 * kDegree);
}

TEST(Lasers, ASensorOverridesItsRangersTiming) {
  const auto all = lasers("ranger( update_interval 50 latency 0.02 sensor() sensor( rate 5 phase 0.1 latency 0.3 ) )");
  EXPECT_DOUBLE_EQ(all[0].rate, 20.0);
  EXPECT_EQ(all[0].latency, 0.02);
  EXPECT_EQ(all[1].rate, 5.0);
  EXPECT_EQ(all[1].phase, 0.1);
  EXPECT_EQ(all[1].latency, 0.3);
}

TEST(Lasers, ARateCountsMoreThanAnInterval) { EXPECT_EQ(lasers("laser( update_interval 50 rate 4 )").at(0).rate, 4.0); }

TEST(Lasers, NoiseIsAStandardDeviationUnlessStagesVarianceIsAskedFor) {
  const std::string text = "laser( noise [0.04 0.01 2] )";
  const LaserNoise ours = lasers(text).at(0).noise;
  EXPECT_DOUBLE_EQ(ours.range_sigma, 0.04);
  EXPECT_DOUBLE_EQ(ours.range_proportional, 0.01);
  EXPECT_DOUBLE_EQ(ours.angle_sigma, 2 * kDegree);
  LoadOptions options;
  options.stage_noise = true;
  EXPECT_DOUBLE_EQ(lasers(text, options).at(0).noise.range_sigma, 0.2);
}

TEST(Lasers, TheLimitsThemselvesAreAllowed) {
  const Laser laser = lasers("laser( fov 360 samples 1000000 range_min 8 range_max 8 )").at(0);
  EXPECT_LE(laser.fov, 2 * M_PI);
  EXPECT_EQ(laser.samples, 1'000'000u);
  EXPECT_EQ(lasers("laser( fov 0 samples 1 )").at(0).fov, 0.0);
}

TEST(Lasers, ALaserThatNobodyCarriesMeasuresNothing) {
  const World world = read_world("laser()");
  EXPECT_TRUE(world.movers.empty());
  EXPECT_EQ(world.walls.size(), 4u);
  EXPECT_NE(warnings_of(world).find("carried by no robot"), std::string::npos);
}

TEST(Lasers, ALaserCalledLaneedgeIsNoRangeFinder) {
  const World world = read_world("position( laser( name \"laneedge\" ) laser() )");
  EXPECT_EQ(world.movers.at(0).lasers.size(), 1u);
  EXPECT_EQ(world.unmodelled.at("laneedge"), 1);
}

TEST(Lasers, ARangerWithoutSensorsIsMentioned) {
  EXPECT_NE(warnings_of(read_world("position( ranger() )")).find("measures nothing"), std::string::npos);
}

TEST(Lasers, NamesAreUniqueOnTheirRobot) {
  const auto all = lasers("laser() laser() ranger( sensor() sensor() ) model( laser() )");
  std::set<std::string> names;
  for (const Laser& laser : all) names.insert(laser.name);
  EXPECT_EQ(names.size(), all.size());
  EXPECT_TRUE(names.contains("model:0.laser:0"));
}

}  // namespace
}  // namespace sf::world
