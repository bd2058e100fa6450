// The sensors of a world, whose settings are parsed once.

#include "sensors/sensor_set.h"

#include <gtest/gtest.h>

#include "sensors/gps.h"
#include "sensors/laser.h"
#include "sensors/laser_modes.h"
#include "sensors/sonar.h"
#include "world/stage/build_world.h"

namespace sf::sensors {
namespace {

world::World three_robots() {
  return world::build_world("three.world",
                            "position( name \"a\" laser( name \"front\" samples 5 range_max 3 )\n"
                            "  ranger( name \"side\" scount 2 spose[0] [0 0 90] spose[1] [0 0 -90] sview [0 2 20] )\n"
                            "  sonar( scount 3 spose[0] [0 0 0] spose[1] [0 0 30] spose[2] [0 0 -30] ) )\n"
                            "position( name \"b\" )\n"
                            "position( name \"c\" laser( samples 9 accuracy \"skip4\" ) )\n",
                            {.sensors = world_file_words()});
}

TEST(SensorSet, SettingsBelongToTheirSensors) {
  const world::World world = three_robots();
  const SensorSet sensor_set(world);
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    const std::vector<LaserSettings> expected = lasers_of(world.movers[m]);
    const auto specs = sensor_set.of(kLaser, m);
    const auto settings = sensor_set.settings_of<CastLaser>(kLaser, m);
    ASSERT_EQ(settings.size(), expected.size());
    ASSERT_EQ(specs.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
      EXPECT_EQ(settings[k].laser.name, expected[k].name);
      EXPECT_EQ(settings[k].laser.samples, expected[k].samples);
      EXPECT_EQ(settings[k].laser.X_MS.yaw, expected[k].X_MS.yaw);
      EXPECT_EQ(specs[k].name, expected[k].name);
      EXPECT_EQ(specs[k].fov, expected[k].fov);
      EXPECT_EQ(specs[k].limit, expected[k].range_max);
    }
  }
  EXPECT_EQ(sensor_set.settings_of<CastLaser>(kLaser).size(), 4u);
  EXPECT_EQ(sensor_set.settings_of<CastLaser>(kLaser, 2)[0].laser.resolution, 4u) << "that of its accuracy mode";
  EXPECT_EQ(sensor_set.settings_of<ConeArray>(kSonar, 0)[0].X_SC.size(), 3u);
}

TEST(SensorSet, WithoutSensorsSettingsAreEmpty) {
  const SensorSet sensor_set(three_robots());
  EXPECT_TRUE(sensor_set.settings_of<CastLaser>(kLaser, 1).empty()) << "a robot without lasers";
  EXPECT_TRUE(sensor_set.settings_of<CastLaser>(kLaser, 3).empty()) << "a robot that joined later";
  EXPECT_TRUE(sensor_set.settings_of<ConeArray>(kSonar, 2).empty()) << "another robot has one";
  EXPECT_TRUE(sensor_set.settings_of<Gps>(kGps, 0).empty()) << "no robot has one";
  EXPECT_TRUE(sensor_set.settings_of<Gps>(kGps).empty());
}

/// A world that is edited afterwards needs another set.
TEST(SensorSet, IsParsedWhenItIsCreated) {
  world::World world = three_robots();
  const SensorSet sensor_set(world);
  for (world::Setting& setting : world.movers[0].sensors[0].settings)
    if (setting.key == "samples") setting.numbers[0] = 6.0;
  EXPECT_EQ(sensor_set.settings_of<CastLaser>(kLaser, 0)[0].laser.samples, 5u);
  EXPECT_EQ(SensorSet(world).settings_of<CastLaser>(kLaser, 0)[0].laser.samples, 6u);
}

TEST(SensorSet, EveryRobotWithARangerOrALaserHasALaser) {
  const world::World world = three_robots();
  for (const world::Mover& mover : world.movers) EXPECT_EQ(has_laser(mover), !lasers_of(mover).empty()) << mover.name;
}

}  // namespace
}  // namespace sf::sensors
