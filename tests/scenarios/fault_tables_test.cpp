// [[fault]] tables of scenarios: keys, errors, and faults in recordings of runs.

#include "scenarios/fault_tables.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "record/recorder.h"
#include "scenarios/recording_verification.h"
#include "scenarios/run_info.h"
#include "scenarios/runner.h"
#include "sensors/laser.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/scenes.h"

namespace sf::scenarios {
namespace {

using base::FaultKind;

constexpr const char* kFile = SF_SOURCE_DIR "/experiments/test.toml";

/// A scenario with one fault of testpath's robot. @param head its robot, sensor and kind
Scenario scenario_with(const std::string& keys,
                       const std::string& head = "robot = \"roomba0\"\nsensor = \"magnetometer\"\n") {
  return parse_scenario(kFile, "world = \"../worlds/testpath/testpath.world\"\n[[fault]]\n" + head + keys);
}

std::string refusal(const std::string& keys,
                    const std::string& head = "robot = \"roomba0\"\nsensor = \"magnetometer\"\n") {
  return refusal_from("test.toml", [&] { check_scenario(scenario_with(keys, head)); });
}

constexpr const char* kAllKinds = R"(
[[fault]]
robot = "*"
sensor = "laser:0"
kind = "bias"
element = 3
offset = 0.1
from = 0.25
until = 1.5
probability = 0.5
[[fault]]
robot = "*"
sensor = "laser:0"
kind = "drift"
rate = -0.125
[[fault]]
robot = "*"
sensor = "laser:0"
kind = "scale"
column = "range_m"
factor = 1.1
[[fault]]
robot = "robot3"
sensor = "laser:0"
kind = "stuck"
from = 0.5
[[fault]]
robot = "*"
sensor = "laser:0"
kind = "spikes"
amplitude = 2
probability = 0.1
[[fault]]
robot = "*"
sensor = "laser:0"
kind = "noise"
sigma = 0.01
[[fault]]
robot = "*"
sensor = "laser:0"
kind = "noise"
factor = 2.5
until = 0.5
[[fault]]
robot = "*"
sensor = "laser:0"
kind = "quantization"
step = 0.05
[[fault]]
robot = "*"
sensor = "laser:0"
kind = "swap"
swap = [0, 60]
[[fault]]
robot = "robot1"
sensor = "encoder:1"
kind = "swap"
swap = ["left_m", "right_m"]
[[fault]]
robot = "*"
sensor = "laser:0"
kind = "dropout"
probability = 0.2
[[fault]]
robot = "*"
sensor = "laser:0"
kind = "delay"
delay = 0.25
from = 1
)";

std::vector<farm::Fault> faults_of(const std::string& text) {
  const std::string name = "faults.toml";
  return read_faults(world::TomlReader(name), world::parse_toml(name, text));
}

TEST(FaultTables, EveryKeyIsRead) {
  const auto faults = faults_of(kAllKinds);
  ASSERT_EQ(faults.size(), 12u);
  const farm::Fault& bias = faults[0];
  EXPECT_EQ(bias.robot, "*");
  EXPECT_EQ(bias.type, "laser");
  EXPECT_EQ(bias.amount, 0.1);
  EXPECT_EQ(bias.element, 3u);
  EXPECT_EQ(bias.from, 0.25);
  EXPECT_EQ(bias.until, 1.5);
  EXPECT_EQ(bias.probability, 0.5);
  EXPECT_EQ(bias.line, 2);
  EXPECT_EQ(faults[1].amount, -0.125);
  EXPECT_EQ(faults[1].until, HUGE_VAL) << "by default until the end";
  EXPECT_EQ(faults[2].column, "range_m");
  EXPECT_FALSE(faults[5].multiplies);
  EXPECT_TRUE(faults[6].multiplies);
  EXPECT_EQ(faults[6].amount, 2.5);
  EXPECT_EQ(faults[8].swapped_elements, (std::vector<std::uint32_t>{0, 60}));
  EXPECT_EQ(faults[9].swapped_columns, (std::vector<std::string>{"left_m", "right_m"}));
  EXPECT_EQ(faults[9].sensor, 1u);
  EXPECT_EQ(faults[11].kind, FaultKind::delay);
  EXPECT_EQ(faults[11].amount, 0.25);
  std::set<FaultKind> kinds;
  for (const farm::Fault& fault : faults) kinds.insert(fault.kind);
  EXPECT_EQ(kinds.size(), base::kFaultNames.size());
}

TEST(FaultTables, TextReadsBackAsTheSameFaults) {
  const std::string text = faults_text(faults_of(kAllKinds));
  EXPECT_EQ("\n" + text, kAllKinds + std::string());
}

TEST(FaultTables, ErrorsHaveTheirLine) {
  EXPECT_EQ(refusal("kind = \"bias\"\noffset = 1e-6\nelement = 4\n"), "");
  expect_in("test.toml:5: there is no fault 'bais'; did you mean 'bias'?", refusal("kind = \"bais\"\n"));
  expect_in("test.toml:2: 'kind' is missing; a fault has robot, sensor and kind", refusal(""));
  expect_in("test.toml:2: 'robot' is missing", refusal("kind = \"stuck\"\n", "sensor = \"gyro\"\n"));
  expect_in("test.toml:2: 'sensor' is missing", refusal("kind = \"stuck\"\n", "robot = \"*\"\n"));
  expect_in("test.toml:2: 'offset' is missing; a fault has offset for the kind bias", refusal("kind = \"bias\"\n"));
  expect_in("a fault has sigma or factor for the kind noise", refusal("kind = \"noise\"\n"));
  expect_in("test.toml:6: noise has both", refusal("kind = \"noise\"\nfactor = 2\nsigma = 1\n"));
  expect_in("'factor' expects a number from 1 to", refusal("kind = \"noise\"\nfactor = 0.5\n"));
  expect_in("test.toml:6: unknown key 'ofset'; did you mean 'offset'?", refusal("kind = \"bias\"\nofset = 1\n"));
  expect_in("test.toml:6: unknown key 'column'", refusal("kind = \"dropout\"\ncolumn = \"a\"\n"));
  expect_in("'delay' expects a number", refusal("kind = \"delay\"\ndelay = 0\n"));
  expect_in("'step' expects a number", refusal("kind = \"quantization\"\nstep = 0\n"));
  expect_in("a fault has probability, of each value, for spikes", refusal("kind = \"spikes\"\namplitude = 1\n"));
  expect_in("'probability' expects a number from 0 to 1", refusal("kind = \"stuck\"\nprobability = 1.5\n"));
  expect_in("test.toml:7: the fault ends at 2 s, not after its start",
            refusal("kind = \"stuck\"\nfrom = 2\nuntil = 2\n"));
  for (const char* list : {"[0]", "[0, \"a\"]", "[0, -1]", "[0, 1.5]", "3", "[\"a\", \"b\", \"c\"]"})
    expect_in("'swap' expects two numbers of elements", refusal("kind = \"swap\"\nswap = " + std::string(list) + "\n"));
  expect_in("columns 'field_T' and 'vector_T' of magnetometer have different widths",
            refusal("kind = \"swap\"\nswap = [\"field_T\", \"vector_T\"]\n"));
  const auto on = [](const std::string& sensor) { return "robot = \"roomba0\"\nsensor = \"" + sensor + "\"\n"; };
  expect_in("test.toml:2: no robot of the world has a sensor 'magnetmeter'; did you mean 'magnetometer'?",
            refusal("kind = \"stuck\"\n", on("magnetmeter")));
  expect_in("test.toml:4: 'laser:x' is not a sensor", refusal("kind = \"stuck\"\n", on("laser:x")));
  expect_in("test.toml:2: no robot is called 'roomba1'; did you mean 'roomba0'?",
            refusal("kind = \"stuck\"\n", "robot = \"roomba1\"\nsensor = \"laser\"\n"));
}

/// Two seconds of robots that wander among boxes with all kinds of faults, recorded with their readings.
record::Recording recorded_with(const std::string& text, base::FaultCounts* counts = nullptr) {
  world::World world = scenes::boxes(20, 8.0, 3);
  sensors::LaserSettings laser = scenes::laser(61, M_PI, 4.0);
  laser.noise = {.range_sigma = 0.01};
  scenes::add_robots(world, 4, laser, 5);
  for (std::uint32_t i = 0; i < world.movers.size(); ++i) world.movers[i].name = "robot" + std::to_string(i);
  world::update_extent_and_hash(world);
  const std::string folder =
      (std::filesystem::temp_directory_path() / ("sf_faults_" + std::to_string(::getpid()))).string();
  const auto faults = faults_of(text);
  Simulation simulation(world, device(), {.seed = 9, .actor = {{.name = "wander"}, {}}, .faults = faults});
  record::Recorder recorder(folder, run_info(world, simulation.farm().sensor_set(),
                                             {.seed = 9, .record_readings = true, .faults = faults_text(faults)}));
  for (int tick = 0; tick < 20; ++tick) recorder.write(simulation.step());
  recorder.finish();
  if (counts != nullptr) *counts = simulation.farm().stats().faults;
  record::Recording recording = record::open_recording(folder);
  std::filesystem::remove_all(folder);
  return recording;
}

TEST(FaultTables, RecordingsMarkFaultyReadingsAndAreVerifiedWithThem) {
  base::FaultCounts counts{};
  record::Recording recording = recorded_with(kAllKinds, &counts);
  base::FaultCounts marked{};
  for (const base::FaultMark& mark : recording.faults)
    for (std::size_t kind = 0; kind < marked.size(); ++kind) marked[kind] += mark.kinds >> kind & 1u;
  EXPECT_EQ(marked, counts);
  for (std::size_t kind = 0; kind < counts.size(); ++kind) EXPECT_GT(counts[kind], 0u) << base::kFaultNames[kind];
  EXPECT_EQ(faults_text(recorded_faults(recording)), faults_text(faults_of(kAllKinds)));

  const Verification sound = verify(recording, device(), {});
  EXPECT_TRUE(sound.sound()) << (sound.damage.empty() ? sound.recomputed[0].first : sound.damage[0]);
  EXPECT_EQ(sound.recomputed[0].readings, recording.readings.size()) << "faulty readings are compared, too";
  ASSERT_EQ(sound.skipped.size(), 1u);
  expect_in("faulty scans in plain C++", sound.skipped[0]);

  std::vector<base::FaultMark> marks = recording.faults;
  recording.faults.pop_back();
  EXPECT_FALSE(verify(recording, device(), {}).sound()) << "a mark is missing";
  recording.faults = marks;
  recording.readings[recording.readings.size() / 2].values[30] += 1e-3;
  EXPECT_FALSE(verify(recording, device(), {}).sound()) << "a faulty reading was changed";
}

/// Readings that no fault affects are compared with plain C++ as ever.
TEST(FaultTables, OtherReadingsAreComparedWithPlainCpp) {
  const record::Recording recording =
      recorded_with("[[fault]]\nrobot = \"robot1\"\nsensor = \"laser\"\nkind = \"bias\"\noffset = 0.2\n");
  const Verification v = verify(recording, device(), {});
  EXPECT_TRUE(v.sound()) << v.reference.first;
  EXPECT_EQ(v.reference.readings, recording.readings.size() - recording.faults.size());
  EXPECT_EQ(recording.faults.size(), recording.readings.size() / 4);
}

}  // namespace
}  // namespace sf::scenarios
