// Visibility depends on heights and on `seen_by_laser` (2.5-D world).

#include <gtest/gtest.h>

#include "raycast/casters.h"
#include "sensors/laser_settings.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

/// A box from 2 to 3 m ahead, with a range of heights.
void add_box(world::World& world, double z_min, double z_max, bool seen = true) {
  const std::size_t first = world.walls.size();
  scenes::add_outline(world, {{2, -1}, {3, -1}, {3, 1}, {2, 1}}, "box" + std::to_string(first));
  for (std::size_t i = first; i < world.walls.size(); ++i) {
    world.walls[i].z_min = z_min;
    world.walls[i].z_max = z_max;
    world.walls[i].seen_by_laser = seen;
  }
}

/// Returns the range of a beam straight ahead at height `z` [m].
double look(world::World world, double z) {
  sensors::LaserSettings laser = eye(1, 0.0, 8.0);
  laser.X_MS.z = z;
  add_eye(world, {}, laser);
  return Glance(world).readings[0].values[0];
}

TEST(Heights, BeamHitsSurfacesAtItsHeight) {
  world::World world;
  add_box(world, 0.1, 0.3);
  EXPECT_EQ(look(world, 0.05), 8.0) << "under it";
  EXPECT_NEAR(look(world, 0.2), 2.0, 1e-12) << "into it";
  EXPECT_EQ(look(world, 0.35), 8.0) << "over it";
  EXPECT_NEAR(look(world, 0.1), 2.0, 1e-12) << "its lower face belongs to it";
  EXPECT_EQ(look(world, 0.3), 8.0) << "its upper face does not";
  EXPECT_EQ(look(world, std::nextafter(0.1, 0.0)), 8.0) << "just under it";
  EXPECT_NEAR(look(world, std::nextafter(0.3, 0.0)), 2.0, 1e-12) << "just below its top";
}

TEST(Heights, BeamIgnoresABoxWithoutEcho) {
  world::World world;
  add_box(world, 0.0, 1.0, false);
  EXPECT_EQ(look(world, 0.2), 8.0);
}

/// A sensor is inside a solid only at the solid's heights: above a low box its view is free.
TEST(Heights, SensorAboveALowBoxIsNotInsideIt) {
  world::World world;
  add_box(world, 0.0, 0.05);
  scenes::add_outline(world, {{5, -1}, {6, -1}, {6, 1}, {5, 1}}, "behind");
  sensors::LaserSettings laser = eye(1, 0.0, 8.0);
  add_eye(world, {2.5, 0, 0, 0}, laser);
  EXPECT_NEAR(Glance(world).readings[0].values[0], 2.5, 1e-12);
}

TEST(Heights, SensorsOfManyHeightsAndRangesShareAWorld) {
  world::World world = scenes::boxes(40, 16.0, 4);
  for (std::size_t i = 0; i < world.walls.size(); ++i) world.walls[i].z_max = 0.02 * static_cast<double>(i / 4 % 12);
  for (int i = 0; i < 12; ++i) {
    sensors::LaserSettings laser = eye(181, 6.0, i % 2 ? 8.0 : 3.0);
    laser.X_MS.z = 0.02 * i;
    add_eye(world, {0.01 * i, 0.0, 0.01 * i, 0.3 * i}, laser);
    laser.range_max = 30.0;
    laser.X_MS.z += 0.013;
    world.movers.back().sensors.push_back(sensors::laser_sensor(laser));
  }
  expect_exact("heights and ranges", sweep(world));
}

/// Robots of several storeys among walls of many heights rise and sink while the farm runs. Each tick equals that of a
/// farm that is loaded with these heights, for all casters, and is right.
TEST(Heights, RobotsAtAHeightReadAsIfLoadedThere) {
  world::World world = scenes::boxes(40, 16.0, 4);
  for (world::Segment& wall : world.walls) {
    if (wall.model < 2) continue;  // the outlines of the room
    wall.z_min = 0.05 * (wall.model % 3);
    wall.z_max = wall.z_min + 0.1 * (wall.model % 5);
  }
  Chance chance(17);
  for (int i = 0; i < 24; ++i) {
    const auto m = scenes::add_robot(world, {}, eye(91, 6.0, i % 3 ? 8.0 : 3.0));
    for (std::size_t k = 0; k < world.movers[m].body.size(); ++k)
      world.movers[m].body[k].z_min = 0.05 * (i % 4), world.movers[m].body[k].z_max = 0.1 + 0.02 * (i % 7);
    world.movers[m].sensors.push_back(sensors::laser_sensor(eye(31, 1.0, 8.0)));
    world.movers[m].sensors.back().X_MS.z = 0.17;
  }
  for (const raycast::CasterType* caster : raycast::casters()) {
    farm::Farm farm(world, device(), {.scene = {.caster = caster}});
    farm.subscribe_all();
    for (int tick = 0; tick < 6; ++tick) {
      world::World now = world;
      std::vector<base::Report> reports;
      for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
        const glm::dvec2 p = chance.in_square(m % 2 == 0 ? 7.0 : 0.4);  // half of them in a crowd
        now.movers[m].X_WM = {p.x, p.y, tick == 0 ? 0.0 : chance.between(-0.3, 0.5), chance.between(-4, 4)};
        reports.push_back({m, 0, now.movers[m].X_WM, {}});
      }
      const auto readings = farm.tick(tick * 100'000'000ll, reports);
      const Glance loaded(now, {.scene = {.caster = caster}});
      expect_same_bits(readings, loaded.readings);
      if (caster == &raycast::host_caster)
        expect_exact(std::to_string(tick), compare(now, loaded_poses(now), readings));
    }
  }
}

/// The pose of a sensor that is rotated, off the robot's centre and above it.
TEST(Heights, SensorPoseIsComposedWithTheMoverPose) {
  world::World world;
  add_box(world, 0.4, 0.6);
  sensors::LaserSettings laser = eye(1, 0.0, 8.0);
  laser.X_MS = {0.25, 0.5, 0.3, -M_PI / 2};
  add_eye(world, {0.5, -0.25, 0.2, M_PI / 2}, laser);
  const Glance glance(world);
  const auto& r = glance.readings[0];
  EXPECT_NEAR(r.X_WS.x, 0.0, 1e-15);
  EXPECT_NEAR(r.X_WS.y, 0.0, 1e-15);
  EXPECT_NEAR(r.X_WS.yaw, 0.0, 1e-15);
  EXPECT_DOUBLE_EQ(r.X_WS.z, 0.5);
  EXPECT_NEAR(r.values[0], 2.0, 1e-12);
}

}  // namespace
}  // namespace sf::trial
