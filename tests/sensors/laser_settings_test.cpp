#include "sensors/laser_settings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

#include "base/error.h"
#include "sensors/sensor_set.h"
#include "tests/units.h"
#include "tests/world/read_world.h"

namespace sf::sensors {
namespace {

using world::LoadOptions;
using world::warnings_of;
using world::World;

World read(const std::string& text, LoadOptions options = {}) {
  options.sensors = world_file_words();
  return world::read_world(text, options);
}

std::vector<LaserSettings> lasers(const std::string& inside, const LoadOptions& options = {}) {
  return lasers_of(read("position( size [0.4 0.4 0.1] " + inside + " )", options).movers.at(0));
}

TEST(Lasers, OlderDialect) {
  const auto all = lasers(
      "laser( fov 90 samples 31 range_min 0.1 range_max 4 resolution 3 laser_color \"green\" pose [0.1 0.2 -0.025 30]"
      " size [0.1 0.1 0.19] )");
  ASSERT_EQ(all.size(), 1u);
  const LaserSettings& laser = all[0];
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

TEST(Lasers, DefaultsOfTheOlderDialect) {
  const LaserSettings laser = lasers("laser()").at(0);
  EXPECT_EQ(laser.samples, 180u);
  EXPECT_DOUBLE_EQ(laser.fov, M_PI);
  EXPECT_EQ(laser.range_max, 8.0);
  EXPECT_EQ(laser.rate, 10.0);
  EXPECT_EQ(laser.resolution, 1u);
  EXPECT_DOUBLE_EQ(laser.X_MS.z, 0.2);
}

TEST(Lasers, NewerDialectHasOneLaserPerSensorInFileOrder) {
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

TEST(Lasers, ArrayOfTheOlderDialect) {
  const auto all = lasers("ranger( scount 2 sview [0.1 2 30] spose[1] [0.1 -0.1 -45] spose[0] [0.1 0.1 45] )");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_DOUBLE_EQ(all[0].X_MS.yaw, 45 * kDegree);
  EXPECT_DOUBLE_EQ(all[1].X_MS.yaw, -45 * kDegree);
  EXPECT_EQ(all[1].range_min, 0.1);
  EXPECT_EQ(all[1].range_max, 2.0);
  EXPECT_DOUBLE_EQ(all[1].fov, 30 * kDegree);
  EXPECT_EQ(all[1].samples, 1u);
}

TEST(Lasers, OldViewSetsRangeAndFieldOfView) {
  const LaserSettings laser = lasers("ranger( sensor( size [0.01 0.04] view [0.1 5 30] ) )").at(0);
  EXPECT_EQ(laser.range_min, 0.1);
  EXPECT_DOUBLE_EQ(laser.fov, 30 * kDegree);
}

TEST(Lasers, SensorOverridesItsRangersTiming) {
  const auto all = lasers("ranger( update_interval 50 latency 0.02 sensor() sensor( rate 5 phase 0.1 latency 0.3 ) )");
  EXPECT_DOUBLE_EQ(all[0].rate, 20.0);
  EXPECT_EQ(all[0].latency, 0.02);
  EXPECT_EQ(all[1].rate, 5.0);
  EXPECT_EQ(all[1].phase, 0.1);
  EXPECT_EQ(all[1].latency, 0.3);
}

TEST(Lasers, RateOverridesInterval) { EXPECT_EQ(lasers("laser( update_interval 50 rate 4 )").at(0).rate, 4.0); }

TEST(Lasers, NoiseIsADeviationUnlessStageNoiseIsRequested) {
  const std::string text = "laser( noise [0.04 0.01 2] )";
  const raycast::ScanNoise ours = lasers(text).at(0).noise;
  EXPECT_DOUBLE_EQ(ours.range_sigma, 0.04);
  EXPECT_DOUBLE_EQ(ours.range_proportional, 0.01);
  EXPECT_DOUBLE_EQ(ours.angle_sigma, 2 * kDegree);
  LoadOptions options;
  options.stage_noise = true;
  EXPECT_DOUBLE_EQ(lasers(text, options).at(0).noise.range_sigma, 0.2);
}

TEST(Lasers, AcceptsTheLimits) {
  const LaserSettings laser = lasers("laser( fov 360 samples 1000000 range_min 8 range_max 8 )").at(0);
  EXPECT_LE(laser.fov, 2 * M_PI);
  EXPECT_EQ(laser.samples, 1'000'000u);
  EXPECT_EQ(lasers("laser( fov 0 samples 1 )").at(0).fov, 0.0);
}

TEST(Lasers, WarnsAboutALaserWithoutARobot) {
  const World world = read("laser()");
  EXPECT_TRUE(world.movers.empty());
  EXPECT_EQ(world.walls.size(), 4u);
  EXPECT_NE(warnings_of(world).find("not mounted on a robot"), std::string::npos);
}

TEST(Lasers, LaserNamedLaneedgeIsALaneEdgeSensor) {
  const World world = read("position( laser( name \"laneedge\" ) laser() )");
  EXPECT_EQ(lasers_of(world.movers.at(0)).size(), 1u);
  EXPECT_EQ(world.movers.at(0).sensors.at(0).type, "laneedge");
}

TEST(Lasers, WarnsAboutARangerWithoutSensors) {
  EXPECT_NE(warnings_of(read("position( ranger() )")).find("measures nothing"), std::string::npos);
}

TEST(Lasers, NamesAreUniquePerRobot) {
  const auto all = lasers("laser() laser() ranger( sensor() sensor() ) model( laser() )");
  std::set<std::string> names;
  for (const LaserSettings& laser : all) names.insert(laser.name);
  EXPECT_EQ(names.size(), all.size());
  EXPECT_TRUE(names.contains("model:0.laser:0"));
}

TEST(Lasers, SettingsRoundTripThroughASensor) {
  LaserSettings laser;
  laser.name = "eye";
  laser.X_MS = {0.1, 0.2, 0.3, 0.4};
  laser.fov = 0.1;
  laser.samples = 7;
  laser.range_min = 0.3;
  laser.range_max = 1.0 / 3.0;
  laser.resolution = 3;
  laser.noise = {0.1, 0.2, 0.3};
  laser.rate = 1.0 / 7.0;
  laser.phase = 0.1;
  laser.latency = 0.2;
  laser.accuracy = {"skip2", "some.world", 3};
  laser.color = 0x12345678u;
  world::Mover mover;
  mover.sensors.push_back(laser_sensor(laser));
  const LaserSettings again = lasers_of(mover).at(0);
  const auto all = [](const LaserSettings& l) {
    return std::tuple(l.name, l.X_MS.x, l.X_MS.y, l.X_MS.z, l.X_MS.yaw, l.fov, l.samples, l.range_min, l.range_max,
                      l.resolution, l.noise.range_sigma, l.noise.range_proportional, l.noise.angle_sigma, l.rate,
                      l.phase, l.latency, l.accuracy.word, l.accuracy.line, l.color);
  };
  EXPECT_EQ(all(again), all(laser));
}

/// A rate or interval of a block overrides the rate and the interval of its ranger.
TEST(Lasers, SensorIntervalOverridesItsRangersRate) {
  EXPECT_DOUBLE_EQ(lasers("ranger( rate 10 sensor( update_interval 50 ) )").at(0).rate, 20.0);
}

TEST(Lasers, MisspeltKeysGetSuggestions) {
  EXPECT_NE(warnings_of(read("position( laser( sampels 3 ) )")).find("did you mean 'samples'"), std::string::npos);
  EXPECT_NE(warnings_of(read("position( ranger( sensor( rnage [0 1] ) ) )")).find("did you mean 'range'"),
            std::string::npos);
  EXPECT_NE(warnings_of(read("position( ranger( range [0 1] sensor() ) )")).find("unknown property 'range'"),
            std::string::npos)
      << "a key of its blocks";
}

TEST(Lasers, ColoursAreNotMeasured) {
  EXPECT_EQ(read("position( laser( laser_color \"red\" ) )").hash, read("position( laser( ) )").hash);
}

/// One error each, with the line that the user has to correct.
TEST(Lasers, RejectsSettingsOutOfRange) {
  struct Bad {
    const char* text;
    int line;
    const char* says;
  };
  for (const Bad& bad : {
           Bad{"laser(\n samples 0 )", 2, "expected 1 to 1000000"},
           {"laser( samples 1000001 )", 1, "'samples' is 1000001; expected 1 to 1000000"},
           {"laser( samples 1.5 )", 1, "whole number"},
           {"laser(\n fov 361 )", 2, "0 to 360"},
           {"laser( fov -1 )", 1, "0 to 360"},
           {"laser(\n range_max 0 )", 2, "more than 0"},
           {"ranger( sensor( view [0 5 30]\n fov 20 ) )", 2, "'fov' is 20, but 'view' states 30"},
           {"laser( range_max 1e8 )", 1, "to 1e+07 m"},
           {"laser(\n range_min 9 )", 2, "smallest range"},
           {"ranger( sensor(\n range [-1 5] ) )", 2, "smallest range"},
           {"ranger( sensor( range [5 1] ) )", 1, "smallest range"},
           {"ranger( sensor( range [5] ) )", 1, "[min max]"},
           {"ranger( sensor(\n view [0 5 361] ) )", 2, "0 to 360"},
           {"laser( noise [0.1] )", 1, "[constant proportional angular]"},
           {"laser( noise [0.1 -1 0] )", 1, "not negative"},
           {"laser( rate 0 )", 1, "'rate' is 0"},
           {"laser( update_interval 0 )", 1, "'update_interval' is 0"},
           {"laser( phase -1 )", 1, "expected 0 to"},
           {"laser( resolution 0 )", 1, "expected 1 to"},
           {"ranger(\n scount 2 spose[0] [0 0 0] )", 2, "spose[1]"},
           {"ranger( scount 0 )", 1, "'scount' is 0; expected 1 to 1000"},
       }) {
    SCOPED_TRACE(bad.text);
    const std::string error = refusal_of([&] { lasers(bad.text); });
    expect_in(fmt::format("test.world:{}: ", bad.line), error);
    expect_in(bad.says, error);
  }
}

}  // namespace
}  // namespace sf::sensors
