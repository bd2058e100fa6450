// Scans whose lists exceed the device's limits run on the host, with equal bytes for every sensor type.

#include <gtest/gtest.h>

#include <cstring>

#include "raycast/casters.h"
#include "sensors/laser_reference.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/cone_trial.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/laneedge_trial.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

using base::Pose;
using base::ReadingBlock;

const farm::FarmOptions kOnDevice{.scene = {.caster = &raycast::device_caster}};
/// No list fits.
const farm::FarmOptions kOnHost{.scene = {.caster = &raycast::device_caster, .longest_list = 0}};
/// No storage buffer holds the results.
const farm::FarmOptions kInTexels{.scene = {.caster = &raycast::device_caster, .largest_buffer = 0}};

/// Runs two ticks of all farms. All robots move in between.
void expect_same_bytes(const world::World& world) {
  farm::Farm on_device(world, device(), kOnDevice);
  farm::Farm on_host(world, device(), kOnHost);
  farm::Farm by_host(world, device(), {.scene = {.caster = &raycast::host_caster}});
  for (farm::Farm* farm : {&on_device, &on_host, &by_host}) farm->subscribe_all();
  for (int tick = 0; tick < 2; ++tick) {
    std::vector<base::Report> reports;
    for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
      Pose X = world.movers[m].X_WM;
      X.x += 0.004 * tick;
      X.yaw += 0.7 * tick;
      reports.push_back({m, 0, X, {}});
    }
    const auto expected = on_device.tick(tick * 1'000'000'000ll, reports);
    const auto given = on_host.tick(tick * 1'000'000'000ll, reports);
    by_host.tick(tick * 1'000'000'000ll, reports);
    SCOPED_TRACE(tick);
    expect_same_bits(expected, given);
  }
  EXPECT_EQ(on_device.hash(), on_host.hash());
  EXPECT_EQ(on_device.hash(), by_host.hash()) << "the caster of the host";
  EXPECT_EQ(on_device.stats().work.host_scans, 0u);
  EXPECT_GT(on_host.stats().work.host_scans, 0u);
}

TEST(HostCast, LasersAmongBoxesAndRobots) {
  world::World world = scenes::boxes(60, 16.0, 3);
  scenes::add_robots(world, 30, scenes::laser(), 3);
  expect_same_bytes(world);
}

TEST(DeviceCast, ResultsBeyondBufferLimitsAreTheSame) {
  world::World world = scenes::boxes(60, 16.0, 3);
  scenes::add_robots(world, 30, scenes::laser(), 3);
  const Glance in_buffers(world, kOnDevice), in_texels(world, kInTexels);
  expect_same_bits(in_buffers.readings, in_texels.readings);
}

/// Angular noise turns beams, `resolution` skips some, range_min raises ranges.
TEST(HostCast, LasersWithNoiseAndResolution) {
  world::World world = scenes::boxes(60, 16.0, 4);
  sensors::LaserSettings laser = scenes::laser(91, 2.0 * M_PI, 5.0);
  laser.noise = {.range_sigma = 0.01, .angle_sigma = 0.01};
  laser.range_min = 0.3;
  scenes::add_robots(world, 10, laser, 4);
  laser.resolution = 3;
  scenes::add_robots(world, 10, laser, 5);
  expect_same_bytes(world);
}

/// Lasers at one place of a robot share a pattern of beams on the host if the beams are evenly spaced: one pattern for
/// robots with equal lasers, another if yaw, field of view, samples or resolution differ.
TEST(HostCast, LasersAtOnePlaceOfARobot) {
  world::World world = scenes::boxes(60, 16.0, 6);
  scenes::add_robots(world, 12, scenes::laser(91, M_PI / 2, 5.0), 6);
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    world.movers[m].sensors.push_back(sensors::laser_sensor(sensors::lasers_of(world.movers[m])[0]));
    scenes::edit_laser(world.movers[m], 1)->X_MS.yaw += m % 6 == 1 ? 1.6 : M_PI / 2;
    for (const std::size_t i : {0, 1}) {
      auto laser = scenes::edit_laser(world.movers[m], i);
      if (m % 6 == 2) laser->fov = 1.54;
      if (m % 6 == 3) laser->samples = 90;
      if (m % 6 == 4) laser->resolution = 2;
    }
  }
  expect_same_bytes(world);
}

/// Both flag the same grazing beams. (Exactly on the wall, the sensor may be on either side.)
TEST(HostCast, AlongWalls) {
  world::World world;
  scenes::add_room(world, {}, 6.0);
  for (const double y : {1e-3, 1e-4, 1e-6}) add_eye(world, {-2.9, -3.0 + y, 0.0, 0.0}, eye(721, M_PI, 8.0));
  expect_same_bytes(world);
}

TEST(HostCast, SonarAndInfraredRings) {
  world::World world = scenes::boxes(40, 8.0, 6);
  for (int i = 0; i < 8; ++i) {
    const Pose X{0.4 * i - 1.6, 0.3 * i - 1.0, 0.0, 0.3 * i};
    add_ranger(world, X,
               cones("sonar", ring(8, 0.15), {cone_setting("fov", {25 * kDegree}), cone_setting("range", {0.1, 5.0})}),
               0.16);
    const world::Setting smooth = cone_setting("incidence", {0.4});
    add_ranger(world, {X.x, -X.y, 0.0, X.yaw}, cones("sonar", ring(8, 0.15), {smooth}), 0.16);
    add_ranger(world, {-X.x, X.y, 0.0, X.yaw}, cones("infrared", ring(5, 0.15)), 0.16);
  }
  expect_same_bytes(world);
}

/// @param resolution [m] of the road's pixels; 0: exact markings
world::World road(double resolution) {
  world::World world;
  world.road_resolution = resolution;
  world.lane_markings.push_back(marking({20.0, 0.1}, {-20.0, 0.1}));
  scenes::add_outline(world, {{1.2, -0.6}, {1.6, -0.6}, {1.6, 0.6}, {1.2, 0.6}}, "box on the road");
  for (int i = 0; i < 6; ++i) {
    add_edge_eye(world, {0.5 * i - 1.0, -0.25 - 0.02 * i, 0.0, M_PI / 2.0});
    scenes::add_robot(world, {0.5 * i - 1.0, 0.35, 0.0, 0.0}, eye(1, 0.0, 1.0));
  }
  return world;
}

TEST(HostCast, LaneEdgesOnExactPaint) { expect_same_bytes(road(0.0)); }
TEST(HostCast, LaneEdgesOnARaster) { expect_same_bytes(road(0.01)); }

/// All robots are at one place, rotated by their index. Three are subscribed.
void crowd_at_one_place(std::uint32_t count) {
  world::World world;
  scenes::add_room(world, {}, 10.0);
  for (std::uint32_t i = 0; i < count; ++i)
    scenes::add_robot(world, {0.0, 0.0, 0.0, 1e-3 * i}, scenes::laser(61, 2.0 * M_PI));
  farm::Farm farm(world, device(), kOnDevice);
  for (const std::uint32_t m : {0u, 1u, count - 1}) farm.subscribe(m, farm::kAllSensorTypes);
  sensors::LaserReference reference(world, 0);
  const auto readings = farm.tick(0, {});
  ASSERT_EQ(readings.size(), 3u);
  for (const ReadingBlock& r : readings) {
    const auto scan = reference.scan(r.mover, r.sensor, r.sequence);
    EXPECT_EQ(std::memcmp(r.values.data(), scan.ranges.data(), r.values.size_bytes()), 0) << r.mover;
    EXPECT_EQ(std::memcmp(r.hits.data(), scan.hits.data(), r.hits.size_bytes()), 0) << r.mover;
  }
}

TEST(HostCast, CrowdOfAThousandAtOnePlace) { crowd_at_one_place(1'000); }
TEST(HostCast, CrowdOfThousandsAtOnePlace) { crowd_at_one_place(6'000); }

/// Cones and lane edges in a crowd. The tests above compare them with the device.
TEST(HostCast, RangersAndLaneEdgesInACrowdAtOnePlace) {
  world::World world = road(0.0);
  const auto array = cones("sonar", ring(4, 0.1));
  add_ranger(world, {}, array, 0.16);
  add_ranger(world, {}, cones("infrared", ring(4, 0.1)), 0.16);
  for (int i = 0; i < 6'000; ++i) scenes::add_robot(world, {0.0, -0.1, 0.0, 1e-3 * i}, eye(1, 0.0, 1.0));
  farm::Farm farm(world, device(), kOnDevice);
  for (std::uint32_t m = 0; m < 14; ++m) farm.subscribe(m, farm::kAllSensorTypes);
  farm.tick(0, {});
  EXPECT_GT(farm.stats().work.host_scans, 0u);
  farm::Farm again(world, device(), kOnHost);
  for (std::uint32_t m = 0; m < 14; ++m) again.subscribe(m, farm::kAllSensorTypes);
  again.tick(0, {});
  EXPECT_EQ(farm.hash(), again.hash());
}

/// The lasers of one robot share a list, built for a disc that contains both: walls hidden from its centre may be
/// visible from its rim.
TEST(SharedLists, ContainWallsVisibleToEitherLaser) {
  for (const double y : {0.3, -0.3}) {
    world::World world;
    const std::uint32_t m = add_eye(world, {}, eye(361, M_PI, 8.0));
    scenes::edit_laser(world.movers[m])->X_MS.y = 0.15;
    world.movers[m].sensors.push_back(sensors::laser_sensor(sensors::lasers_of(world.movers[m])[0]));
    scenes::edit_laser(world.movers[m], 1)->X_MS.y = -0.15;
    scenes::add_robot(world, {1.0, 0.0, 0.0, 0.0}, eye(1, 0.0, 1.0));
    const std::uint32_t behind = scenes::add_robot(world, {2.5, y, 0.0, 0.0}, eye(1, 0.0, 1.0));
    const Glance glance(world);
    const auto& hits = glance.readings[y > 0.0 ? 0 : 1].hits;
    EXPECT_GT(std::count(hits.begin(), hits.end(), world.movers[behind].model), 3) << y;
    expect_exact("past a neighbour", sweep(world));
  }
}

/// Robots with two lasers each, close to each other and to walls: no surface visible to either laser is missing.
TEST(SharedLists, CrowdsOfRobotsWithTwoLasers) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    world::World world = scenes::boxes(12, 6.0, seed);
    scenes::add_robots(world, 25, scenes::laser(181, 2.0 * M_PI, 5.0), seed);
    for (world::Mover& mover : world.movers) {
      mover.sensors.push_back(sensors::laser_sensor(sensors::lasers_of(mover)[0]));
      scenes::edit_laser(mover)->X_MS.y += 0.15;
      scenes::edit_laser(mover, 1)->X_MS.y -= 0.12;
      scenes::edit_laser(mover, 1)->X_MS.x += 0.05;
    }
    expect_exact("two lasers each", sweep(world));
  }
}

/// Duplicate walls are equally near, so no beam that hits one is certain. 5 400 lanes of the second kernel, more than a
/// row of its groups.
TEST(SharedLists, EveryBeamUncertain) {
  world::World world = scenes::cave(60, 12.0, 5);
  const std::vector<world::Segment> walls = world.walls;
  world.walls.insert(world.walls.end(), walls.begin(), walls.end());
  scenes::add_robots(world, 60, scenes::laser(360, 2.0 * M_PI, 40.0), 5);
  for (world::Mover& mover : world.movers) mover.body.clear();
  expect_same_bytes(world);
  farm::Farm farm(world, device(), kOnDevice);
  farm.subscribe_all();
  farm.tick(0, {});
  EXPECT_EQ(farm.stats().work.uncertain, 60u * 360u) << "each counts once, though padding repeats the last lane";
}

/// Tables that have grown since the kernels were bound are bound again.
TEST(SharedLists, GrownTablesAreBoundAgain) {
  world::World world = scenes::cave(60, 30.0, 2);
  scenes::add_robots(world, 40, scenes::laser(), 2);
  farm::Farm farm(world, device(), {.scene = {.caster = &raycast::device_caster, .pool_chunks = 512, .pool_cells = 2}});
  farm.subscribe(0, farm::kAllSensorTypes);
  farm.tick(0, {});
  farm.subscribe_all();
  const auto readings = farm.tick(1'000'000'000, {});
  EXPECT_EQ(readings.size(), 40u);
  expect_exact("after the tables grew", compare(world, loaded_poses(world), readings));
}

}  // namespace
}  // namespace sf::trial
