// Fields of view and numbers of samples of all sizes.

#include <gtest/gtest.h>

#include <array>

#include "raycast/beams.h"
#include "raycast/casters.h"
#include "sensors/accuracy.h"
#include "sensors/laser_settings.h"
#include "tests/farm/small_farm.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/scenes.h"
#include "tests/units.h"

namespace sf::trial {
namespace {

TEST(Fans, EveryWidthAndCount) {
  world::World world = scenes::boxes(30, 16.0, 2);
  Chance chance(1);
  for (const double fov : {0.0, 1e-6, 1e-3, 10 * kDegree, 180 * kDegree, 270 * kDegree, 360 * kDegree})
    for (const std::uint32_t samples : {1, 2, 3, 4, 5, 6, 7, 8, 31, 33, 64, 65, 361, 1001}) {
      const glm::dvec2 p = chance.in_square(7.0);
      add_eye(world, {p.x, p.y, 0.0, chance.between(-10.0, 10.0)}, eye(samples, fov, 8.0));
    }
  expect_exact("fans", sweep(world));
}

/// A heading of many turns, and every heading at which a beam falls on the boundary of two direction sectors.
TEST(Fans, EveryHeading) {
  world::World world = scenes::boxes(30, 16.0, 2);
  for (int i = -40; i < 40; ++i) {
    add_eye(world, {0.3, 0.2, 0.0, i * M_PI / 32}, eye(33, M_PI, 30.0));
    add_eye(world, {0.3, 0.2, 0.0, i * M_PI / 32 + 1e-9}, eye(5, 2.0 * M_PI, 30.0));
    add_eye(world, {0.3, 0.2, 0.0, 1000.0 * i}, eye(5, 1.0, 30.0));
  }
  expect_exact("headings", sweep(world));
}

/// Adds a robot whose lasers share one point, like infrared spots in Stage. @param fans (samples, fov, heading) of each
void add_spots(world::World& world, const base::Pose& pose, const std::vector<std::array<double, 3>>& fans) {
  const std::uint32_t mover = scenes::add_robot(world, pose, eye(1, 0.0, 4.0));
  sensors::LaserSettings laser = sensors::lasers_of(world.movers[mover])[0];
  scenes::remove_lasers(world.movers[mover]);
  for (const auto& [samples, fov, heading] : fans) {
    laser.samples = static_cast<std::uint32_t>(samples);
    laser.fov = fov;
    laser.X_MS.yaw = heading;
    world.movers[mover].sensors.push_back(sensors::laser_sensor(laser));
  }
}

world::World spots() {
  world::World world = scenes::boxes(40, 8.0, 3);
  std::vector<std::array<double, 3>> ring;
  for (int i = 0; i < 12; ++i) ring.push_back({1, 0.0, i * 30 * kDegree});
  Chance chance(5);
  for (int i = 0; i < 40; ++i) {
    const glm::dvec2 p = chance.in_square(3.5);
    const base::Pose X{p.x, p.y, 0.0, chance.between(-10.0, 10.0)};
    // Evenly spaced all around; several at one bearing; of different width, including a full turn; too uneven to share.
    if (i % 4 == 0) add_spots(world, X, ring);
    if (i % 4 == 1) add_spots(world, X, {{1, 0, 0.5}, {1, 0, 0.5}, {1, 0, -0.5}, {1, 0, 7.0}});
    if (i % 4 == 2) add_spots(world, X, {{9, 1.0, 0.0}, {5, 2 * M_PI, 0.3}, {2, M_PI, 2.0}, {361, 2 * M_PI, 0.0}});
    if (i % 4 == 3) add_spots(world, X, {{40, 0.01, 0.0}, {1, 0.0, 3.0}, {1, 0.0, M_PI}});
  }
  return world;
}

TEST(Fans, OfOneRobotAtOnePoint) { expect_exact("spots", sweep(spots())); }

/// Beams that graze are flagged with either caster, regardless of their place among the beams of the robot's scanners.
TEST(Fans, OfOneRobotAlongAWall) {
  world::World world;
  scenes::add_room(world, {}, 6.0);
  for (const double y : {1e-4, 1e-5, 1e-6}) {
    const std::uint32_t mover = add_eye(world, {-2.9, -3.0 + y, 0.0, 0.0}, eye(1, 0.0, 8.0));
    sensors::LaserSettings laser = sensors::lasers_of(world.movers[mover])[0];
    scenes::remove_lasers(world.movers[mover]);
    for (const double heading : {1.0, 2.0, 3.0, -1e-5, 0.5, -2e-5}) {
      laser.X_MS.yaw = heading;
      laser.samples = heading == 2.0 ? 7 : 1;
      laser.fov = heading == 2.0 ? 4.0 : 0.0;
      world.movers[mover].sensors.push_back(sensors::laser_sensor(laser));
    }
  }
  expect_exact("along a wall", sweep(world));
  const Glance glance(world);
  EXPECT_TRUE(std::ranges::any_of(glance.readings, [](const auto& r) { return !r.quality.empty(); }));
}

TEST(Fans, OfOneRobotInThirtyTwoBits) {
  world::World world = spots();
  sensors::set_accuracy(world, "single");
  sweep(world);
}

/// Scanners at one point are cast together when all are due, and separately otherwise.
TEST(Fans, OfOneRobotWithDifferentRates) {
  world::World world = spots();
  for (world::Mover& mover : world.movers) {
    scenes::edit_laser(mover, sensors::lasers_of(mover).size() - 1)->rate = 5.0;
    scenes::edit_laser(mover)->range_min = 0.5;
  }
  std::uint64_t hashes[2];
  for (const bool host : {false, true}) {
    farm::Farm farm(world, device(), {.scene = {.caster = host ? &raycast::host_caster : &raycast::device_caster}});
    farm.subscribe_all();
    for (int tick = 0; tick < 4; ++tick) farm.tick(tick * 100'000'000ll, farm::reports_at(world, tick));
    hashes[host ? 1 : 0] = farm.hash();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

}  // namespace
}  // namespace sf::trial
