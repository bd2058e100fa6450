// Lidars and robots on height maps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "robots/fleet.h"
#include "sensors/lidar.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

const std::string kMap = "terrain( file \"" SF_SOURCE_DIR "/tests/fuzz/terrain/three_by_two.png\" ";

/// Level ground 2 m above the floor, under a robot and 20 m about it: beams that pass its border meet the floor.
TEST(LidarTerrain, ReplacesTheFloorInItsRectangle) {
  const world::World world =
      world_of(kMap +
               "size [40 40] heights [2 2] )\n"
               "position( name \"r\" pose [1 2 0 0] size [0.4 0.4 0.4] "
               "lidar( channels 3 fov_v [-30 -4] columns 8 pose6 [0 0 1 0 0 0] size [0 0 0.2] ) )");
  farm::Farm farm(world, host_device(), {.noise = false, .threads = 1});
  const base::ReadingBlock reading = farm.sense(0, sensors::kLidar, 0, world.movers[0].X_WM);
  EXPECT_EQ(world.movers[0].X_WM.z, 2.0);
  for (std::size_t i = 0; i < reading.values.size(); ++i) {
    const double down = std::sin(M_PI / 180.0 * (i < 8 ? 30.0 : i < 16 ? 17.0 : 4.0));
    EXPECT_EQ(reading.hits[i], base::kFloorHit) << i;
    const double range = reading.values[i], height = range * down, ground = i < 16 ? 0.0 : 2.0;
    if (i < 16 || height < 2.0) {
      EXPECT_NEAR(range * down, 1.5, 1e-7) << i;
    } else {
      EXPECT_NEAR(range * down, 1.5 + ground, 1e-7) << i;
    }
  }
  EXPECT_TRUE(std::ranges::any_of(reading.values.subspan(16), [](double r) { return r > 40.0; })) << "past its border";
}

/// A robot that drives up a slope of 1 in 4 rises with it and tilts; its lidar tilts with it and looks along the slope.
TEST(LidarTerrain, RobotsFollowSlopes) {
  const world::World world = world_of("terrain( file \"" SF_SOURCE_DIR
                                      "/tests/fuzz/terrain/slope.png\" size [40 40] heights [0 10] )\n"
                                      "position( name \"r\" pose [-5 0 0.1 0] velocity_bounds [-2 2 0 0 0 0 -90 90] "
                                      "lidar( channels 1 fov_v [0 0] columns 9 fov 40 size [0 0 0] ) )");
  robots::Fleet fleet(world);
  const base::Twist ahead{.forward = 1.0};
  EXPECT_NEAR(fleet.reports()[0].tilt.pitch, -std::atan(0.25), 1e-6) << "at the start";
  for (int tick = 0; tick < 20; ++tick) fleet.move({&ahead, 1}, 100'000'000);
  const base::Report& report = fleet.reports()[0];
  EXPECT_NEAR(report.X_WM.x, -3.0, 1e-9);
  EXPECT_NEAR(report.X_WM.z, 5.0 + 0.25 * -3.0 + 0.1, 1e-4) << "its height above the ground stays";
  EXPECT_NEAR(report.tilt.pitch, -std::atan(0.25), 1e-6);
  EXPECT_NEAR(report.tilt.roll, 0.0, 1e-6);
  farm::Farm farm(world, host_device(), {.noise = false, .threads = 1});
  const base::ReadingBlock reading = farm.sense(0, sensors::kLidar, 0, report.X_WM, report.tilt);
  EXPECT_TRUE(std::ranges::all_of(reading.values, [](double r) { return r == 100.0; }))
      << "beams parallel to the ground";
}

}  // namespace
}  // namespace sf::trial
