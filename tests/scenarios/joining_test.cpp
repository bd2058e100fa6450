// Robots that join and leave a run.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>

#include "base/error.h"
#include "base/files.h"
#include "raycast/casters.h"
#include "record/recorder.h"
#include "record/recording.h"
#include "scenarios/recorded_states.h"
#include "scenarios/recording_verification.h"
#include "scenarios/run_info.h"
#include "scenarios/runner.h"
#include "scenarios/simulation.h"
#include "sensors/laser.h"
#include "sensors/laser_modes.h"
#include "sensors/sensor_type.h"
#include "tests/cluster/thread_ranks.h"
#include "tests/device.h"
#include "tests/farm/small_farm.h"
#include "tests/refusal.h"
#include "world/append_robot.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {
namespace {

/// Robots with a sensor of every type that has a state or its own table, at rates with readings between two ticks, with
/// noise and a latency. They are far apart: none is in the range of another.
const char* const kWorld = R"(
interval_sim 100
define probe position
(
  size [0.3 0.3 0.2]
  velocity_bounds [-0.5 0.5 -0.5 0.5 -0.5 0.5 -60 60]
  laser ( name "front" samples 31 fov 180 range_max 4 rate 10 noise [0.02 0 0] )
  laser ( name "late" samples 7 fov 90 range_max 4 rate 7 latency 0.25 )
  sonar ( scount 4 spose[0] [0.1 0 0] spose[1] [0.1 0.1 30] spose[2] [0.1 -0.1 -30] spose[3] [-0.1 0 180]
          range [0 3] fov 20 arrays 1 )
  magnetometer ( )
  encoder ( slip 0.1 )
  battery ( )
  ptz ( views 2 view[0] [0 0 40 1] view[1] [30 0 20 0.5] )
  gyro ( )
  occupancy ( laser "front" cell 0.25 words [8 8] log_odds [85 40 350] )
)
model ( size [1 1 1] pose [2 1 0 0] )
model ( size [1 1 1] pose [42 1 0 0] )
probe ( name "a" pose [0 0 0 0] ctrl "wander" )
)";

world::World world_of(const std::string& more = "") {
  return world::build_world("joining.world", kWorld + more, {.sensors = sensors::world_file_words()});
}

SimulationOptions options_of(const char* caster) {
  SimulationOptions options{.seed = 5};
  options.actor.controller.name.clear();
  options.caster = raycast::caster_named(caster);
  return options;
}

using Readings = std::map<std::uint32_t, std::vector<farm::Kept>>;

void keep(const base::TickRecord& tick, Readings& into) {
  for (const base::ReadingBlock& reading : tick.readings) {
    into[reading.mover].push_back(farm::keep(reading));
    into[reading.mover].back().sensor += 100u * reading.type;
  }
}

/// Drives all robots on circles; calls `act` before each step.
template <class Act>
Readings run(Simulation& simulation, const world::World& world, int ticks, Act&& act) {
  Readings readings;
  for (int tick = 0; tick < ticks; ++tick) {
    act(tick);
    std::vector<base::Twist> commands(world.movers.size(), {0.3, 0.0, 0.4});
    if (tick % 7 > 3) commands.assign(commands.size(), {});  // caches are filled while robots are at rest
    simulation.command(commands);
    keep(simulation.step(), readings);
  }
  return readings;
}

/// Random numbers, encoders, maps, firing cycles, held and cached readings of one robot continue bitwise while others
/// join and leave.
TEST(Joining, ChangesNoReadingOfARobotOutOfRange) {
  for (const char* caster : {"host", "vulkan"}) {
    world::World alone = world_of(), joined = world_of();
    Simulation one(alone, device(), options_of(caster)), two(joined, device(), options_of(caster));
    const Readings expected = run(one, alone, 60, [](int) {});
    const Readings readings = run(two, joined, 60, [&](int tick) {
      if (tick == 0) two.add_robot(joined, {.name = "first", .like = "a", .X_WM = {80.0, 0.0, 0.0, 0.0}});
      if (tick == 23) two.add_robot(joined, {.name = "b", .like = "probe", .X_WM = {40.0, 0.0, 0.0, 0.0}});
      if (tick == 40) two.remove_robot(2);
      if (tick == 47) two.add_robot(joined, {.name = "b", .like = "first", .X_WM = {40.0, 0.5, 0.0, 0.0}});
    });
    EXPECT_EQ(joined.movers.size(), 3u);
    EXPECT_GT(readings.at(2).size(), 50u);
    EXPECT_EQ(readings.at(0), expected.at(0)) << caster;
  }
}

/// A robot that joins has the same readings, and affects others in the same way, as one that was absent until then.
TEST(Joining, MatchesARobotThatWasAbsentUntilThen) {
  for (const char* caster : {"host", "vulkan"})
    for (const int when : {0, 1, 23}) {
      const std::string b = "probe ( name \"b\" pose [1 -2 0 0] )\n";
      const world::World both = world_of(b);
      Simulation absent(both, device(), options_of(caster));
      absent.set_absent(1, true);
      const Readings expected = run(absent, both, 50, [&](int tick) {
        if (tick == when) absent.set_absent(1, false);
        if (tick == 35) absent.set_absent(1, true);
      });
      world::World growing = world_of();
      Simulation simulation(growing, device(), options_of(caster));
      const Readings readings = run(simulation, growing, 50, [&](int tick) {
        if (tick == when) simulation.add_robot(growing, {.name = "b", .like = "a", .X_WM = {1.0, -2.0, 0.0, 0.0}});
        if (tick == 35) simulation.remove_robot(1);
      });
      EXPECT_EQ(readings, expected) << caster << ", tick " << when;
      EXPECT_EQ(simulation.farm().hash(), absent.farm().hash()) << caster << ", tick " << when;
      EXPECT_EQ(growing.hash, both.hash);
    }
}

/// The first sensors of a type create their own table.
TEST(Joining, AddsSensorsOfANewType) {
  const std::string gps = "define spotter position ( size [0.2 0.2 0.2] gps ( ) )\n";
  world::World with = world_of(gps + "spotter ( name \"s\" pose [5 5 0 0] )\n");
  Simulation simulation(with, device(), options_of("host"));
  run(simulation, with, 5, [](int) {});
  EXPECT_EQ(simulation.add_robot(with, {.name = "t", .like = "spotter", .X_WM = {6.0, 5.0, 0.0, 0.0}}), 2u);
  const Readings readings = run(simulation, with, 10, [](int) {});
  EXPECT_EQ(readings.at(2).size(), readings.at(1).size());
}

/// Others see and touch the robot after it joins, and no longer after it leaves.
TEST(Joining, HasABodyUntilItLeaves) {
  world::World world = world_of();
  Simulation simulation(world, device(), options_of("host"));
  const auto nearest = [&] {
    double least = 1e9;
    const base::TickRecord tick = simulation.step();
    for (const base::ReadingBlock& reading : tick.readings)
      if (reading.mover == 0 && reading.type == 1 && reading.sensor == 0) least = reading.values[15];
    return least;
  };
  simulation.step();
  simulation.add_robot(world, {.name = "b", .like = "a", .X_WM = {1.0, 0.0, 0.0, 0.0}});
  EXPECT_NEAR(nearest(), 0.85, 0.1);
  EXPECT_EQ(simulation.status(1).drives, false);
  simulation.remove_robot(1);
  EXPECT_GT(nearest(), 1.2);
  EXPECT_TRUE(base::is_absent(simulation.step().reports[1].X_WM));
  EXPECT_EQ(simulation.add_robot(world, {.name = "b", .like = "a", .X_WM = {1.0, 0.0, 0.0, 0.0}}), 1u);
  EXPECT_NEAR(nearest(), 0.85, 0.1);
}

TEST(Joining, AcceptsAController) {
  world::World world = world_of();
  Simulation simulation(world, device(), options_of("host"));
  simulation.step();
  simulation.add_robot(world, {.name = "b", .like = "a", .X_WM = {8.0, 8.0, 0.0, 0.0}, .actor = {}});
  for (int tick = 0; tick < 20; ++tick) simulation.step();
  EXPECT_TRUE(simulation.status(1).drives);
  const auto lasers = simulation.farm().sensor_set().settings_of<sensors::CastLaser>(sensors::kLaser, 1);
  ASSERT_EQ(lasers.size(), 2u);
  EXPECT_EQ(lasers[1].laser.samples, 7u) << "those of its original";
  EXPECT_GT(simulation.step().reports[1].X_WM.x, 8.1);
}

std::string refusal(Simulation& simulation, world::World& world, const JoiningRobot& robot) {
  const std::uint64_t hash = world.hash;
  const std::size_t models = world.models.size();
  try {
    simulation.add_robot(world, robot);
  } catch (const base::InputError& error) {
    EXPECT_EQ(world.hash, hash);
    EXPECT_EQ(world.models.size(), models);
    simulation.step();
    return error.what();
  }
  return "none";
}

TEST(Joining, RefusalsGiveAReasonAndChangeNothing) {
  world::World world = world_of();
  Simulation simulation(world, device(), options_of("host"));
  const auto message = [&](const JoiningRobot& robot) { return refusal(simulation, world, robot); };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_PRED2(has, message({.name = "a", .like = "a", .X_WM = {}}), "the name 'a' is taken");
  EXPECT_PRED2(has, message({.name = "a.front", .like = "a", .X_WM = {}}), "letters, digits or '_'");
  EXPECT_PRED2(has, message({.name = "", .like = "a", .X_WM = {}}), "letters, digits or '_'");
  EXPECT_PRED2(has, message({.name = "9", .like = "a", .X_WM = {}}), "a letter first");
  EXPECT_PRED2(has, message({.name = std::string(65, 'x'), .like = "a", .X_WM = {}}), "1 to 64");
  EXPECT_PRED2(has, message({.name = "b", .like = "prob", .X_WM = {}}), "has no robot or type of robots 'prob'");
  EXPECT_PRED2(has, message({.name = "b", .like = "a", .X_WM = {NAN, 0.0, 0.0, 0.0}}), "expected finite numbers");
  EXPECT_PRED2(has, message({.name = "b", .like = "a", .X_WM = {1e9, 0.0, 0.0, 0.0}}), "within 1e+07 m");
  JoiningRobot parks{.name = "b", .like = "a", .X_WM = {}};
  parks.actor.controller.name = "unknown";
  EXPECT_NE(message(parks), "none");
  EXPECT_EQ(world.movers.size(), 1u);
  EXPECT_THROW(simulation.remove_robot(1), base::InputError);
  simulation.remove_robot(0);
  EXPECT_THROW(simulation.remove_robot(0), base::InputError);
}

TEST(Joining, TheNumberOfRobotsIsBounded) {
  world::World world = world_of();
  world.movers.resize(world::kMostMovers, world.movers[0]);
  EXPECT_THROW(world::append_robot(world, 0, "b", {}), base::InputError);
}

/// Every reading of robots that join, leave and return between ticks is recomputed.
TEST(Joining, RecordingsAreVerified) {
  const std::string folder = (std::filesystem::temp_directory_path() / "joining").string();
  world::World world = world_of();
  {
    Simulation simulation(world, device(), options_of("host"));
    const auto info = [&] {
      return run_info(world, simulation.farm().sensor_set(),
                      {.seed = 5, .record_readings = true, .joined = simulation.joined()});
    };
    record::Recorder recorder(folder, info(), {.compression = record::Compression::none});  // each tick at once
    for (int tick = 0; tick < 50; ++tick) {
      if (tick == 11 || tick == 30)
        simulation.add_robot(world, {.name = "b", .like = "a", .X_WM = {1.0, -2.0, 0.0, 1.0}});
      if (tick == 17) simulation.add_robot(world, {.name = "c", .like = "b", .X_WM = {0.1, -2.3, 0.0, 0.3}});
      if (tick == 11 || tick == 17) recorder.add_movers(info());
      if (tick == 22) simulation.remove_robot(1);
      const std::vector<base::Twist> commands(world.movers.size(), {0.3, 0.0, 0.4});
      simulation.command(commands);
      recorder.write(simulation.step());
    }
    const record::Recording open = record::open_recording(folder);
    EXPECT_EQ(open.info.movers.size(), 3u);
    EXPECT_EQ(open.ticks, 50u);
    recorder.finish();
  }
  const record::Recording recording = record::open_recording(folder);
  EXPECT_TRUE(recording.damage.empty()) << recording.damage.front();
  EXPECT_FALSE(recording.truncated);
  ASSERT_EQ(recording.states.size(), 3u);
  for (const auto& states : recording.states) EXPECT_EQ(states.size(), 50u);
  for (int tick = 0; tick < 50; ++tick) {
    EXPECT_EQ(base::is_absent(recording.states[1][tick].X_WM), tick < 11 || (tick >= 22 && tick < 30)) << tick;
    EXPECT_EQ(base::is_absent(recording.states[2][tick].X_WM), tick < 17) << tick;
  }
  EXPECT_EQ(recorded_world(recording).hash, world.hash);
  const Verification v = verify(recording, device(), {.sample = 0});
  EXPECT_TRUE(v.sound()) << v.reference.first << (v.damage.empty() ? "" : v.damage.front()) << v.missing;
  EXPECT_EQ(v.missing, 0u);
  EXPECT_GT(v.reference.readings, 100u);
}

/// A file truncated at any byte is read to its last complete tick, with the robots of that time.
TEST(Joining, TruncatedRecordingsAreReadable) {
  const std::string folder = (std::filesystem::temp_directory_path() / "joining_cut").string();
  world::World world = world_of();
  Simulation simulation(world, device(), options_of("host"));
  const auto info = [&] {
    return run_info(world, simulation.farm().sensor_set(), {.seed = 5, .joined = simulation.joined()});
  };
  record::Recorder recorder(folder, info());
  recorder.write(simulation.step());
  const std::uint64_t before = recorder.size();
  simulation.add_robot(world, {.name = "b", .like = "a", .X_WM = {1.0, -2.0, 0.0, 1.0}});
  recorder.add_movers(info());
  recorder.write(simulation.step());
  const std::string bytes = base::read_text(folder + "/run.mcap");
  for (std::size_t size = before; size <= bytes.size(); ++size) {
    const auto* const data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    const record::Recording cut = record::read_recording({data, size}, "cut");
    const world::World then = recorded_world(cut);
    ASSERT_EQ(cut.states.size(), then.movers.size());
    ASSERT_TRUE(has_all_states(cut)) << size;
  }
}

std::string scenario_text(const std::string& events) {
  return "world = \"joining.world\"\nduration = 3\n[default]\ncontroller = \"none\"\n" + events;
}

ScenarioResult run_events(const std::string& events) {
  const std::string folder = std::filesystem::temp_directory_path().string();
  std::ofstream(folder + "/joining.world") << kWorld;
  return run_scenario(parse_scenario(folder + "/joining.toml", scenario_text(events)), device());
}

std::string joining_refusal(const std::string& events) {
  return refusal_from("joining.toml", [&] { run_events(events); });
}

const std::string kAdd = "[[event]]\nat = 1\nadd = \"b\"\nlike = \"a\"\npose = [8, 8, 0]\ncontroller = \"wander\"\n";

TEST(Joining, ScenariosAddAndRemoveRobots) {
  const ScenarioResult result =
      run_events(kAdd + "[[event]]\nat = 2\nremove = \"a\"\n[expect]\ndistance = { b = 0.3 }\n");
  ASSERT_EQ(result.outcomes.size(), 1u);
  EXPECT_TRUE(result.outcomes[0].met) << result.outcomes[0].measured;
  EXPECT_EQ(run_events(kAdd).hash, run_events(kAdd).hash);
  EXPECT_NE(run_events(kAdd).hash, run_events("").hash);
}

TEST(Joining, ErrorsOfEventsNameLineAndRemedy) {
  const std::string later = "[[event]]\nat = 2\n";
  const std::pair<std::string, std::string> kCorpus[] = {
      {"[[event]]\nat = 1\nadd = \"b\"\npose = [0, 0, 0]\n", "joining.toml:5: 'like' is missing"},
      {"[[event]]\nat = 1\nremove = \"z\"\n", "joining.toml:5: "},
      {"[[event]]\nremove = \"a\"\n", "joining.toml:5: 'at' is missing"},
      {"[[event]]\nat = 1\nremove = \"a\"\npresent = true\n", "joining.toml:8: unknown key 'present'"},
      {"[[event]]\nat = 1\nadd = \"a\"\nlike = \"a\"\npose = [0, 0, 0]\n", "joining.toml:5: the name 'a' is taken"},
      {"[[event]]\nat = 1\nadd = \"b\"\nlike = \"q\"\npose = [0, 0, 0]\n", "joining.toml:5: "},
      {"[[event]]\nat = 3\nadd = \"b\"\nlike = \"a\"\npose = [0, 0, 0]\n",
       "joining.toml:5: 'b' would join after the end"},
      {later + "remove = \"a\"\n" + later + "remove = \"a\"\n", "joining.toml:8: row 0 has no robot"},
  };
  for (const auto& [text, message] : kCorpus)
    EXPECT_EQ(joining_refusal(text).substr(0, message.size()), message) << text;
}

/// Ranks that share a fleet give the readings of a single process, whichever robots join and leave.
TEST(Joining, RanksAgree) {
  const auto go = [](Simulation& simulation, world::World& world) {
    for (int tick = 0; tick < 40; ++tick) {
      for (int k = 0; k < 3; ++k)
        if (tick == 7 + 5 * k) {
          JoiningRobot robot{
              .name = "late" + std::to_string(k), .like = "a", .X_WM = {2.0 * k, 6.0, 0.0, 0.0}, .actor = {}};
          simulation.add_robot(world, robot);
        }
      if (tick == 20) simulation.remove_robot(2);
      if (tick == 26)
        simulation.add_robot(world, {.name = "late0", .like = "a", .X_WM = {0.0, 8.0, 0.0, 0.0}, .actor = {}});
      simulation.step();
    }
    simulation.settle();
  };
  SimulationOptions options{.seed = 5, .threads = 1};
  world::World alone = world_of("probe ( name \"z\" pose [10 0 0 0] )\n");
  Simulation one(alone, device(), options);
  go(one, alone);
  std::vector<std::unique_ptr<gpu::Device>> devices;
  for (int rank = 0; rank < 3; ++rank) devices.push_back(std::make_unique<gpu::Device>());
  cluster::ThreadRanks(3).run([&](cluster::Ranks& rank) {
    world::World world = world_of("probe ( name \"z\" pose [10 0 0 0] )\n");
    SimulationOptions shared = options;
    shared.ranks = &rank;
    Simulation simulation(world, *devices[rank.rank()], shared);
    go(simulation, world);
    if (rank.rank() == 0) {
      EXPECT_EQ(simulation.farm().hash(), one.farm().hash());
    }
  });
}

}  // namespace
}  // namespace sf::scenarios
