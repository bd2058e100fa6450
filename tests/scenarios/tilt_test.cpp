// Tilted robots in scenarios and recordings.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/files.h"
#include "record/recorder.h"
#include "scenarios/recording_verification.h"
#include "scenarios/run_info.h"
#include "scenarios/runner.h"
#include "scenarios/scenario.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::scenarios {
namespace {

constexpr const char* kWorld =
    "model( name \"wall\" pose [4 0 0 10] size [0.2 12 3] )\n"
    "define rover position( size [0.4 0.4 0.5] lidar( channels 4 columns 60 rate 13 ) encoder( rate 7 ) )\n"
    "rover( name \"r1\" pose [0 0 0 20] )\nrover( name \"r2\" pose [2 0.5 0 30] )\n";

/// Runs 1 s with `text` after the scenario's head.
std::uint64_t hash_with(const std::string& text) {
  const std::string folder = std::filesystem::temp_directory_path() / ("tilt_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/w.world") << kWorld;
  const std::string head = "world = \"w.world\"\nduration = 1\n[default]\ncontroller = \"none\"\n";
  const Scenario scenario = parse_scenario(folder + "/t.toml", head + text);
  const std::uint64_t hash = run_scenario(scenario, host_device()).hash;
  std::filesystem::remove_all(folder);
  return hash;
}

/// At the start and by an event. Six numbers without tilt are the four.
TEST(TiltedRobots, StandInScenarios) {
  for (const std::string head : {"[[robot]]\nname = \"r1\"\n", "[[event]]\nat = 0.45\nobject = \"r1\"\n"}) {
    const std::uint64_t level = hash_with(head + "pose = [0.5, 0, 0.25, 20]\n");
    EXPECT_EQ(hash_with(head + "pose = [0.5, 0, 0.25, 0, 0, 20]\n"), level) << head;
    EXPECT_NE(hash_with(head + "pose = [0.5, 0, 0.25, 5, 0, 20]\n"), level) << head;
    EXPECT_NE(hash_with(head + "pose = [0.5, 0, 0.25, 0, 5, 20]\n"), level) << head;
    for (const std::string bad : {"[0, 0, 0, 0, 20]", "[0, 0, 0, 181, 0, 20]", "[0, 0, 0, 0, 91, 20]",
                                  "[0, 0, 0, nan, 0, 20]", "[0, 0, 0, 0, 0, 0, 20]"})
      expect_in("'pose' expects", refusal_of([&] { hash_with(head + "pose = " + bad + "\n"); }));
  }
}

/// One second of robots that drive, tilted from the start or from a tick on. @param file set to the recording's bytes
record::Recording recorded(const base::Tilt& start, const base::Tilt& later, std::string& file) {
  const auto folder = std::filesystem::temp_directory_path() / ("tilts_" + std::to_string(::getpid()));
  world::World world = trial::world_of(kWorld);
  {
    Simulation simulation(world, host_device(), {.actor = {{.name = ""}, {}}, .tilts = {{0, start}}});
    record::Recorder recorder(folder.string(),
                              run_info(world, simulation.farm().sensor_set(), {.record_readings = true}),
                              {.compression = record::Compression::none});
    simulation.command(std::vector<base::Twist>{{0.5, 0.0, 1.0}, {-0.2, 0.0, 0.0}});
    for (int tick = 0; tick < 10; ++tick) {
      if (tick == 4) simulation.put(1, {2.0, 0.5, 0.125, 0.5}, later);
      recorder.write(simulation.step());
    }
    recorder.finish();
  }
  file = base::read_text((folder / "run.mcap").string());
  record::Recording recording = record::open_recording(folder.string());
  std::filesystem::remove_all(folder);
  return recording;
}

/// To the bit, between ticks too; and planar recordings have not one byte of it.
TEST(TiltedRobots, AreRecordedAndRecomputed) {
  std::string file;
  for (const base::Tilt& start : {base::Tilt{}, base::Tilt{0.1, -0.2}}) {
    record::Recording recording = recorded(start, {-0.3, 0.05}, file);
    EXPECT_NE(file.find("/tilts"), std::string::npos);
    for (std::size_t tick = 0; tick < 10; ++tick) {
      EXPECT_EQ(recording.states[0][tick].tilt.pitch, start.pitch) << tick;
      EXPECT_EQ(recording.states[1][tick].tilt.roll, tick < 4 ? 0.0 : -0.3) << tick;
      EXPECT_EQ(recording.states[1][tick].tilt.pitch, tick < 4 ? 0.0 : 0.05) << tick;
    }
    const Verification sound = verify(recording, host_device(), {});
    EXPECT_TRUE(sound.sound());
    EXPECT_EQ(sound.missing, 0u);
    ASSERT_FALSE(sound.recomputed.empty());
    for (const Comparison& c : sound.recomputed) EXPECT_EQ(c.largest, 0.0) << c.type << " " << c.first;
    recording.states[1][5].tilt.roll += 1e-6;
    EXPECT_FALSE(verify(recording, host_device(), {}).sound());
  }
  recorded({}, {}, file);
  EXPECT_EQ(file.find("ilts"), std::string::npos);
  EXPECT_EQ(file.find("Wheels"), std::string::npos);
}

/// A car starts on ice: its encoders count wheels that spin, to the bit in a replay. Without their speeds, as in
/// recordings of earlier versions, replays count the path.
TEST(SpinningWheels, AreRecordedAndRecomputed) {
  const auto folder = std::filesystem::temp_directory_path() / ("wheels_" + std::to_string(::getpid()));
  const world::World world = trial::world_of(
      "position( name \"car\" size [4.2 1.7 1.4] drive \"car\" wheelbase 2.4 track 1.4 velocity_bounds [0 30 0 0 0 0 "
      "-90 "
      "90] dynamics \"car friction=0.1\" encoder( rate 25 per_count 0.001 ) )");
  double counted = 0.0, way = 0.0;
  {
    Simulation simulation(world, host_device(), {.actor = {{.name = ""}, {}}});
    record::Recorder recorder(folder.string(),
                              run_info(world, simulation.farm().sensor_set(), {.record_readings = true}), {});
    simulation.command(std::vector<base::Twist>{{20.0, 0.0, 0.0}});
    for (int tick = 0; tick < 20; ++tick) {
      const base::TickRecord record = simulation.step();
      recorder.write(record);
      way = record.reports[0].X_WM.x;
      for (const base::ReadingBlock& reading : record.readings) counted = reading.values[0];
    }
    recorder.finish();
  }
  EXPECT_GT(way, 0.1);
  EXPECT_GT(counted, 2.0 * way);
  record::Recording recording = record::open_recording(folder.string());
  std::filesystem::remove_all(folder);
  const Verification sound = verify(recording, host_device(), {});
  EXPECT_TRUE(sound.sound());
  for (const Comparison& c : sound.recomputed) EXPECT_EQ(c.largest, 0.0) << c.first;
  for (auto& state : recording.states[0]) state.wheels = {};
  EXPECT_FALSE(verify(recording, host_device(), {}).sound());
}

}  // namespace
}  // namespace sf::scenarios
