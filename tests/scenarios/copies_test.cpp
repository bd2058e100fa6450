// Copies of a world: each gives the bytes of that world alone.

#include <gtest/gtest.h>

#include <functional>

#include "scenarios/simulation.h"
#include "sensors/sensor_type.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "world/copies.h"
#include "world/free_space.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {
namespace {

/// Robots with sensors of many types, at rates that are no divisors of the tick, and readings that arrive late.
constexpr const char* kMixed = R"(
  interval_sim 100
  define box model( size [1 1 1] )
  box( pose [0 6 0 0] size [12 0.2 1] ) box( pose [0 -6 0 0] size [12 0.2 1] )
  box( pose [6 0 0 0] size [0.2 12 1] ) box( pose [-6 0 0 0] size [0.2 12 1] )
  box( pose [2 1 0 30] size [1 2 1] fiducial_return 4 )
  define bot position( size [0.3 0.3 0.3] drive "diff" localization "odom" fiducial_return 7
    laser( samples 61 fov 240 range_max 5 rate 7 latency 0.05 noise [0.02 0 0.1] )
    sonar( spose[0] [0.1 0 0] spose[1] [0 0.1 90] sview [0.1 4 20] scount 2 rate 3 noise 0.01 )
    gyro( noise 0.01 bias 0.02 rate 20 ) encoder( slip 0.05 rate 10 )
    fiducialfinder( range_max 4 fov 180 rate 4 ) lidar( channels 2 fov_v [-5 5] columns 24 range [0 6] rate 4 rolling 1 )
    battery( capacity 1 rate 2 ) gps( rate 5 noise 0.5 ) )
  bot( name "a" pose [-3 -3 0 0] )
  bot( name "b" pose [-3 3 0 90] )
  bot( name "c" pose [3 -3 0 180] )
)";

world::World mixed() { return world::build_world("mixed.world", kMixed, {.sensors = sensors::world_file_words()}); }

/// Moves the robots to the free places that a seed chooses.
void place(world::World& world, std::uint32_t copy, std::uint64_t seed) {
  const std::size_t movers = world.movers.size() / world.copies;
  const world::World alone = mixed();
  const auto poses = world::free_poses(alone, alone.movers[0], static_cast<std::uint32_t>(movers), seed);
  for (std::size_t m = 0; m < movers; ++m) world.movers[copy * movers + m].X_WM = poses[m];
}

SimulationOptions wandering(std::uint64_t seed, unsigned threads = 0) {
  return {.seed = seed, .threads = threads, .actor = {.controller = {.name = "wander"}}};
}

std::uint64_t hash_alone(std::uint64_t seed, int ticks) {
  world::World world = mixed();
  place(world, 0, seed);
  Simulation simulation(world, device(), wandering(seed));
  for (int i = 0; i < ticks; ++i) simulation.step();
  return simulation.farm().hash();
}

world::World copies(std::uint32_t count, std::uint64_t seed) {
  world::World world = mixed();
  world::copy_movers(world, count);
  for (std::uint32_t k = 0; k < count; ++k) place(world, k, seed + k);
  return world;
}

TEST(Copies, EachHasTheBytesOfItsWorldAlone) {
  const world::World world = copies(4, 5);
  for (const unsigned threads : {1u, 3u}) {
    Simulation simulation(world, device(), wandering(5, threads));
    for (int i = 0; i < 40; ++i) simulation.step();
    for (std::uint32_t k = 0; k < 4; ++k) EXPECT_EQ(simulation.farm().hash(k), hash_alone(5 + k, 40)) << k;
  }
}

TEST(Copies, ARestartHasTheBytesOfANewRunAndLeavesTheOthers) {
  world::World world = copies(3, 5);
  Simulation simulation(world, device(), wandering(5));
  for (int i = 0; i < 13; ++i) simulation.step();
  const std::uint64_t before = simulation.farm().hash(0);
  place(world, 1, 77);
  const farm::Farm::Restart again[] = {{1, 77}};
  simulation.restart(again);
  EXPECT_EQ(simulation.farm().hash(0), before);
  EXPECT_EQ(simulation.farm().hash(1), hash_alone(77, 1));
  for (int i = 0; i < 30; ++i) simulation.step();
  EXPECT_EQ(simulation.farm().hash(0), hash_alone(5, 43));
  EXPECT_EQ(simulation.farm().hash(1), hash_alone(77, 31));
  EXPECT_EQ(simulation.farm().hash(2), hash_alone(7, 43));
}

}  // namespace
}  // namespace sf::scenarios
