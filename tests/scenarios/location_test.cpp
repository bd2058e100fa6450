// Poses of overhead cameras as inputs of derived sensors, and the experiment `location`.

#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/simulation.h"
#include "sensors/location.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {
namespace {

constexpr std::size_t kValid = 2, kSource = 6, kAge = 7;

world::World seen_world(const std::string& more = "") {
  return world::build_world("seen.world",
                            "define bot position( size [0.3 0.3 0.1] gps( noise 1 rate 5 )\n"
                            "derived( type \"location\" inputs [\"camera\" \"gps\"] rate 10 max_age 0.5 ) )\n"
                            "bot( name \"r0\" pose [3 4 0 0] ) bot( name \"r1\" pose [-3 1 0 90] )" +
                                more,
                            {.sensors = sensors::world_file_words()});
}

/// The locations of a robot in 3 s, in which it drives.
std::vector<std::vector<double>> locations(const world::World& world, SimulationOptions options, std::uint32_t mover,
                                           std::vector<base::Pose>* truth = nullptr) {
  options.actor.controller.name = "";
  Simulation simulation(world, host_device(), std::move(options));
  std::vector<std::vector<double>> all;
  const std::vector<base::Twist> twists(world.movers.size(), {0.2, 0.0, 0.0});
  for (int tick = 0; tick < 30; ++tick) {
    for (const base::ReadingBlock& reading : simulation.step().readings) {
      if (reading.type != sensors::kLocation || reading.mover != mover) continue;
      all.emplace_back(reading.values.begin(), reading.values.end());
      if (truth != nullptr) truth->push_back(reading.X_WM);
    }
    simulation.command(twists);
  }
  return all;
}

TEST(CameraInputs, ReachDerivedSensorsLateAndStopInOutages) {
  // Where a robot has a camera of its own, "camera" is still what the sensor expects.
  const world::World world = seen_world(" position( name \"eye\" pose [9 9 0 0] camera( resolution [4 3] ) )");
  std::vector<base::Pose> truth;
  PositioningOptions positioning;
  positioning.link.delay = 0.2;
  positioning.outages = {{1.0, 2.0}};
  const auto rows = locations(world, {.positioning = positioning}, 1, &truth);
  ASSERT_EQ(rows.size(), 30u);
  EXPECT_EQ(rows[0][kSource], 1.0) << "the first pose is on its way";
  EXPECT_EQ(rows[5][kSource], 0.0);
  EXPECT_NEAR(rows[5][kAge], 0.2, 1e-9);
  EXPECT_NEAR(rows[5][0], truth[3].x, 1e-12) << "the true pose of 0.2 s ago";
  EXPECT_NEAR(rows[5][1], truth[3].y, 1e-12);
  EXPECT_EQ(rows[13][kSource], 0.0) << "the last one is 0.4 s old";
  EXPECT_EQ(rows[16][kSource], 1.0) << "0.7 s old";
  EXPECT_EQ(rows[23][kSource], 0.0) << "back after 2.2 s";
}

/// Poses depend on the seed and the robot alone.
TEST(CameraInputs, AreTheSameForAnyNumberOfThreads) {
  const world::World world = seen_world();
  PositioningOptions positioning;
  positioning.position_sigma = 0.1;
  positioning.link = {.delay = 0.1, .jitter = 0.2, .loss = 0.3, .seed = 3};
  const auto once = locations(world, {.threads = 1, .positioning = positioning}, 0);
  EXPECT_EQ(std::isnan(once[20][0]), false);
  const auto again = locations(world, {.threads = 3, .positioning = positioning}, 0);
  for (std::size_t i = 0; i < once.size(); ++i) {
    if (once[i][kValid] == 1.0) {
      EXPECT_EQ(once[i], again[i]) << i;
    }
  }
}

TEST(CameraInputs, AreMissedWithoutPositioning) {
  const world::World world = seen_world();
  const Simulation without(world, host_device(), {});
  ASSERT_EQ(without.warnings().size(), 1u);
  expect_in("inputs 'camera' of derived sensors receive nothing", without.warnings()[0].message);
  const Simulation with(world, host_device(), {.positioning = PositioningOptions{}});
  EXPECT_TRUE(with.warnings().empty());
}

}  // namespace
}  // namespace sf::scenarios
