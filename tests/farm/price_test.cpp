// Cost of a world's contents, without a clock: device memory, submissions, casts.

#include <gtest/gtest.h>

#include <map>

#include "raycast/casters.h"
#include "sensors/laser.h"
#include "sensors/magnetometer.h"
#include "tests/farm/small_farm.h"
#include "tests/sensors/cone_scenes.h"
#include "tests/sensors/magnet_scenes.h"

namespace sf::farm {
namespace {

/// Names and sizes of all device allocations for `world`, by sensor type.
std::map<std::string, std::vector<std::pair<std::string, std::size_t>>> held_for(const world::World& world) {
  gpu::Device own;
  Farm farm(world, own);
  farm.subscribe_all();
  for (int k = 0; k < 3; ++k) farm.tick(k * 100'000'000ll, reports_at(world, k));
  std::map<std::string, std::vector<std::pair<std::string, std::size_t>>> held;
  for (const gpu::DeviceAllocation& h : own.allocations()) held[h.owner].emplace_back(h.name, h.bytes);
  return held;
}

std::size_t bytes_of(const world::World& world) {
  std::size_t bytes = 0;
  for (const auto& [type, tables] : held_for(world))
    for (const auto& [name, size] : tables) bytes += size;
  return bytes;
}

TEST(Price, AbsentTypesUseNoMemory) {
  world::World world = small_world(4);
  const auto lasers = held_for(world);
  ASSERT_EQ(lasers.size(), 1u);
  EXPECT_EQ(lasers.begin()->first, "laser");

  for (int i = 0; i < 400; ++i) world.magnets.push_back(scenes::magnet({0.02 * i, 0.0}));
  world.lane_markings.push_back({{{-4.0, 0.0}, {4.0, 0.0}}, 0.1});
  EXPECT_EQ(held_for(world), lasers) << "magnets and paint without sensors for them";

  world.movers[0].sensors.push_back(scenes::five());
  const auto both = held_for(world);
  EXPECT_EQ(both.at("laser"), lasers.at("laser")) << "another type adds no work for lasers";
  EXPECT_TRUE(both.contains("magnetometer"));
  EXPECT_FALSE(both.contains("laneedge"));
}

/// The lists' initial size depends on the number of sensing robots, up to the limits in the options.
TEST(Price, FewRobotsUseLittleMemory) {
  constexpr std::size_t kMiB = 1u << 20;
  EXPECT_LT(bytes_of(small_world(6)), 8 * kMiB);
  EXPECT_LT(bytes_of(small_world(50)), 24 * kMiB);
  EXPECT_GT(bytes_of(small_world(50)), bytes_of(small_world(6)));
}

/// Kernels join the batch at the first subscription; readings do not depend on when that is.
TEST(Price, TypesSubscribedLaterGiveTheSameReadings) {
  world::World world = small_world(6);
  world.magnets.push_back(scenes::magnet({0.5, 0.5}));
  for (world::Mover& mover : world.movers) {
    mover.sensors.push_back(scenes::five());
    mover.sensors.push_back(trial::cones("infrared", trial::ring(4, 0.1)));
  }
  auto caster = &raycast::host_caster;
  const auto readings = [&](const std::vector<base::SensorTypes>& subscribed) {
    Farm farm(world, device(), {.reuse_unchanged = false, .scene = {.caster = caster}});
    std::vector<Kept> kept;
    for (int k = 0; k < 12; ++k) {
      for (std::uint32_t m = 0; m < world.movers.size(); ++m)
        farm.subscribe(m, subscribed[static_cast<std::size_t>(k / 3)]);
      for (const auto& r : farm.tick(k * 100'000'000ll, reports_at(world, k)))
        if (k >= 9) kept.push_back(keep(r));
    }
    return kept;
  };
  const std::uint32_t laser = 1u << sensors::kLaser, magnets = 1u << sensors::kMagnetometer;
  const std::vector<Kept> all = readings({kAllSensorTypes, kAllSensorTypes, kAllSensorTypes, kAllSensorTypes});
  EXPECT_EQ(all.size(), 3u * 6u * 3u);
  for (const auto each : {&raycast::host_caster, &raycast::device_caster}) {
    caster = each;
    EXPECT_EQ(readings({laser, 0, laser | magnets, kAllSensorTypes}), all);
    EXPECT_EQ(readings({0, magnets, laser, kAllSensorTypes}), all);
  }
}

TEST(Price, UnsubscribedSensorsCastAndSubmitNothing) {
  const world::World world = small_world(20);
  Farm farm(world, device());
  for (int k = 0; k < 20; ++k) farm.tick(k * 100'000'000ll, reports_at(world, k));
  EXPECT_EQ(farm.stats().batches, 0u);
  EXPECT_EQ(farm.stats().work.rays, 0u);
  EXPECT_EQ(farm.stats().work.cells_built, 0u);
}

/// 10 Hz with ticks of a millisecond: one batch per hundred ticks.
TEST(Price, SensorsThatAreNotDueSubmitNothing) {
  const world::World world = small_world(20);
  Farm farm(world, device(), kOnDevice);
  farm.subscribe_all();
  for (int k = 0; k < 1000; ++k) farm.tick(k * 1'000'000ll, reports_at(world, k));
  EXPECT_EQ(farm.stats().batches, 10u);
  EXPECT_EQ(farm.stats().work.rays, 10u * 20u * kBeams);
}

TEST(Price, FleetAtRestCastsAndSubmitsNothing) {
  const world::World world = small_world(20);
  Farm farm(world, device(), kOnDevice);
  farm.subscribe_all();
  for (int k = 0; k < 50; ++k) farm.tick(k * 100'000'000ll, reports_at(world, 0));
  EXPECT_EQ(farm.stats().readings, 50u * 20u);
  EXPECT_LE(farm.stats().batches, 3u);
  EXPECT_LE(farm.stats().work.rays, 3u * 20u * kBeams);
}

/// Host scans need no batch and give the same bytes.
TEST(Price, HostScansSubmitNothing) {
  const world::World world = small_world(20);
  Farm by_host(world, device(), {.scene = {.caster = &raycast::host_caster}});
  Farm by_device(world, device(), kOnDevice);
  for (Farm* farm : {&by_host, &by_device}) {
    farm->subscribe_all();
    for (int k = 0; k < 5; ++k) farm->tick(k * 100'000'000ll, reports_at(world, k));
  }
  EXPECT_EQ(by_host.stats().batches, 0u);
  EXPECT_EQ(by_device.stats().batches, 5u);
  EXPECT_EQ(by_host.hash(), by_device.hash());
}

/// One robot drives, the others are at rest: only robots that may see it measure again.
TEST(Price, OnlyRobotsInRangeMeasureADrivingRobot) {
  world::World world;
  scenes::add_room(world, {}, 60.0);
  for (int i = 0; i < 10; ++i)
    scenes::add_robot(world, {5.0 * i - 25.0, 0.0, 0.0, 0.0}, scenes::laser(kBeams, M_PI, 4.0));
  Farm farm(world, device());
  farm.subscribe_all();
  for (int k = 0; k < 3; ++k) farm.tick(k * 100'000'000ll, {});
  const FarmStats before = farm.stats();
  const base::Report moved{0, 0, {-25.0, 0.5, 0.0, 0.0}, {}};
  farm.tick(300'000'000, {&moved, 1});
  EXPECT_EQ(farm.stats().work.rays - before.work.rays, kBeams) << "its neighbour is 5 m away";
  const base::Report nearer{0, 0, {-23.0, 0.5, 0.0, 0.0}, {}};
  farm.tick(400'000'000, {&nearer, 1});
  EXPECT_EQ(farm.stats().work.rays - before.work.rays, 3 * kBeams);
}

}  // namespace
}  // namespace sf::farm
