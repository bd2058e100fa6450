// Copies of a world: each gives the bytes of that world alone.

#include <gtest/gtest.h>

#include <functional>
#include <map>

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

/// Returns a world whose robots have a sensor of one type, and what it derives its readings from.
world::World with(const sensors::SensorType& type) {
  const std::map<std::string_view, std::string> settings = {
      {"laser", "samples 9 rolling 1 noise [0.01 0 0.01]"},
      {"gyro", "noise 1 bias 1"},
      {"encoder", "slip 0.05"},
      {"gps", "noise 0.5"},
      {"imu", "preset \"MPU-6050\" gyro_walk 1 accel_instability 1 rate 20"},
      {"camera", "resolution [4 3] rgb 1 noise 0.1 rolling 1"},
      {"lidar", "channels 2 columns 16 rolling 1 dropout 0.1"},
      {"battery", "capacity 0.01"},
      {"occupancy", "words [10 10] cell 0.2"},
      {"localization", "inputs [\"encoder\" \"gyro\" \"gps\"]"},
      {"sideslip", "inputs [\"gyro\" \"encoder\" \"command\"]"},
      {"monitor", "inputs [\"encoder\" \"gyro\" \"gps\"]"},
      {"link-speed", "inputs [\"*/localization\"] links 1 link[0] [-5 0 5 0]"},
      {"features", "inputs [\"laser\"]"},
      {"tracks", "inputs [\"features\" \"localization\"]"},
      {"location", "inputs [\"localization\" \"gps\"] choose \"weighted\""},
      {"aggregate", "inputs [\"gyro\"] quantity \"rate_rad_s\""},
  };
  const auto found = settings.find(type.name);
  std::string sensor = (found == settings.end() ? "" : found->second) + " latency 0.05 )\n";
  if (type.derived == nullptr)
    sensor = std::string(type.word.type) + "( " + sensor;
  else
    sensor =
        "gyro( noise 1 rate 10 ) encoder( slip 0.05 ) gps( noise 0.5 rate 5 ) laser( samples 61 )\n"
        "derived( type \"localization\" inputs [\"encoder\" \"gyro\" \"gps\"] )\n"
        "derived( type \"features\" inputs [\"laser\"] )\nderived( type \"" +
        std::string(type.name) + "\" name \"tried\" " + sensor;
  if (type.derived_from != 0) sensor = "laser( samples 61 )\n" + sensor;
  return world::build_world("each.world",
                            "define bot position( size [0.4 0.3 0.3] drive \"car\" " + sensor +
                                ")\nbot( name \"a\" pose [-2 0 0 0] ) bot( name \"b\" pose [2 0.5 0 170] )\n"
                                "model( size [1 1 1] pose [0 2 0 0] fiducial_return 3 )",
                            {.sensors = sensors::world_file_words()});
}

/// Nothing that a sensor keeps between its readings may survive the end of an episode.
TEST(Copies, ARestartOfAnySensorHasTheBytesOfANewRun) {
  const auto drive = [](Simulation& simulation, std::size_t robots, int ticks) {
    simulation.command(std::vector<base::Twist>(robots, {0.4, 0.0, 0.3}));
    for (int i = 0; i < ticks; ++i) simulation.step();
  };
  for (const sensors::SensorType* type : sensors::built_in_sensor_types()) {
    if (type->name == "model") continue;  // needs a file
    world::World world = with(*type);
    const world::World one = world;
    world::copy_movers(world, 2);
    Simulation copies(world, device(), {.seed = 5, .threads = 1}), alone(one, device(), {.seed = 77, .threads = 1});
    drive(copies, 4, 13);
    const farm::Farm::Restart again[] = {{1, 77}};
    copies.restart(again);
    drive(alone, 2, 1);
    EXPECT_EQ(copies.farm().hash(1), alone.farm().hash()) << type->name;
    drive(copies, 4, 12), drive(alone, 2, 12);
    EXPECT_EQ(copies.farm().hash(1), alone.farm().hash()) << type->name;
  }
}

}  // namespace
}  // namespace sf::scenarios
