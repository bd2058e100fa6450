// A tick after warm-up allocates nothing. The test replaces `operator new` and counts only calls of the calling thread:
// the Vulkan driver's threads may allocate.

#include <gtest/gtest.h>

#include "tests/counted_new.h"
#include "tests/farm/small_farm.h"
#include "tests/sensors/cone_scenes.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/host_trial.h"
#include "tests/sensors/magnet_scenes.h"

namespace sf::farm {
namespace {

using counted::allocations;
using counted::counting;

/// One lap returns to the same cells and neighbours.
std::uint64_t allocations_per_lap(const world::World& world, const FarmOptions& options) {
  Farm farm(world, device(), options);
  farm.subscribe_all();
  std::vector<std::vector<base::Report>> reports;
  for (int k = 0; k < 8; ++k) reports.push_back(reports_at(world, k));
  std::int64_t now = 0;
  return counted::when_warm(options.threads == 1 ? 3 : 60, [&] {
    for (const auto& report : reports) farm.tick(now, report), now += 100'000'000;
  });
}

TEST(Allocation, CountsAllocations) {
  counting = true;
  allocations = 0;
  const auto made = std::make_unique<std::vector<int>>(100);
  counting = false;
  EXPECT_EQ(allocations, 2u);
}

TEST(Allocation, NoneInATickAfterWarmUp) {
  for (const unsigned threads : {1u, 2u}) EXPECT_EQ(allocations_per_lap(small_world(20), {.threads = threads}), 0u);
}

TEST(Allocation, NoneWithNoiseAndLatency) {
  world::World world = small_world(20, {.range_sigma = 0.01, .angle_sigma = 0.001});
  for (world::Mover& mover : world.movers) scenes::edit_laser(mover)->latency = 0.25;
  EXPECT_EQ(allocations_per_lap(world, {.threads = 2}), 0u);
}

/// Static and moving magnets, with and without a cut-off.
TEST(Allocation, NoneWithMagnetometers) {
  world::World world = scenes::sheet(300, 6.0, 1);
  for (int i = 0; i < 12; ++i) {
    const auto m = scenes::add_carrier(world, {0.4 * i - 2.0, 0.0, 0.0, 0.0}, scenes::five());
    world.movers[m].sensors[0].settings.push_back(scenes::setting("noise", {0.01}));
    world.movers[m].magnets.push_back(scenes::magnet({0.1, 0.0}));
  }
  for (const double cutoff : {0.0, 1.0}) {
    world.magnet_cutoff = cutoff;
    EXPECT_EQ(allocations_per_lap(world, {.threads = 2}), 0u) << cutoff;
  }
}

TEST(Allocation, NoneWithMaps) {
  world::World world = small_world(8);
  for (world::Mover& mover : world.movers) {
    world::Sensor map;
    map.type = "occupancy";
    map.name = "map";
    map.settings.push_back(scenes::setting("rate", {5.0}));
    map.settings.push_back(scenes::setting("log_odds", {mover.id % 2 == 0 ? 0.0 : 1.0}));
    mover.sensors.push_back(map);
  }
  EXPECT_EQ(allocations_per_lap(world, {.threads = 2}), 0u);
}

/// Sensors without device work: a roof overhead, a hole in the floor, a dock and a virtual wall.
TEST(Allocation, NoneWithHostSensors) {
  world::World world;
  for (int i = 0; i < 12; ++i) {
    const auto m = scenes::add_carrier(world, {0.4 * i - 2.0, 0.0, 0.0, 0.0}, trial::fitted("bumper"));
    auto& sensors = world.movers[m].sensors;
    for (const char* type : {"cliff", "irreceiver", "lightsensor", "battery", "fiducial", "radar"})
      sensors.push_back(trial::fitted(type));
    world::Setting input = scenes::setting("input[0]", {0.01});
    input.text = "light";
    sensors.push_back(trial::fitted("analog", {input}));
    sensors.push_back(trial::fitted("ptz"));
    sensors.push_back(trial::fitted("encoder", {scenes::setting("slip", {0.01})}));
    sensors.push_back(trial::fitted("gyro", {scenes::setting("noise", {0.1}), scenes::setting("bias", {0.1})}));
    sensors.push_back(trial::fitted("gps", {scenes::setting("noise", {1.0}), scenes::setting("rate", {10.0})}));
  }
  trial::add_solid(world, trial::square({0, 0}, 1.5), 0.5, 0.6);
  world.floor_holes.push_back({trial::square({1, 0}, 0.7), 0});
  using Kind = world::Emitter::Kind;
  for (const Kind kind : {Kind::dock, Kind::virtual_wall})
    world.emitters.push_back({kind, world::kNone, {2, 0, 0, 0}, 2.0, 0.7, 0.5});
  world.lamps.push_back({world::kNone, {2, 2, 1, 0}, 100.0});
  for (const unsigned threads : {1u, 2u}) EXPECT_EQ(allocations_per_lap(world, {.threads = threads}), 0u) << threads;
}

/// Transducers in sequence and all at once, with noise, among walls and each other.
TEST(Allocation, NoneWithSonarAndInfrared) {
  world::World world = small_world(20);
  for (world::Mover& mover : world.movers) {
    mover.sensors.push_back(trial::cones("sonar", trial::ring(16, 0.1),
                                         {trial::cone_setting("arrays", {2}), trial::cone_setting("noise", {0.01}),
                                          trial::cone_setting("incidence", {1.0})}));
    mover.sensors.push_back(trial::cones("infrared", trial::ring(8, 0.1), {trial::cone_setting("range", {0, 0.5})}));
  }
  for (const unsigned threads : {1u, 2u}) EXPECT_EQ(allocations_per_lap(world, {.threads = threads}), 0u);
}

}  // namespace
}  // namespace sf::farm
