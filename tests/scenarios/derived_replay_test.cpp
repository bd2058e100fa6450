// Derived sensors computed from recordings: bit for bit those of the run, and from recordings of other programs.

#include "scenarios/derived_replay.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "base/error.h"
#include "base/time.h"
#include "record/mcap_writer.h"
#include "record/recorder.h"
#include "record/ros_messages.h"
#include "record/schemas.h"
#include "record/standard_readings.h"
#include "scenarios/foreign_recording.h"
#include "scenarios/recorded_states.h"
#include "scenarios/run_info.h"
#include "scenarios/simulation.h"
#include "sensors/derived/derived_type.h"
#include "sensors/gps.h"
#include "sensors/gyro.h"
#include "sensors/laser.h"
#include "sensors/localization.h"
#include "tests/device.h"
#include "tests/folder.h"
#include "tests/refusal.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {
namespace {

class DerivedReplayTest : public FolderTest {
 protected:
  /// Two seconds of two robots with sensors of different rates and latencies that drive in circles.
  record::Recording run(const std::string& name, const std::string& derived, bool readings = true) const {
    const world::World world =
        world::build_world("derived.world",
                           "define bot position( size [0.3 0.3 0.1] drive \"diff\" encoder( rate 23 slip 0.01 )\n"
                           "gyro( rate 37 noise 1 bias 1 latency 0.07 ) gps( rate 5 noise 0.5 latency 0.11 ) " +
                               derived + " )\nbot( name \"r0\" pose [0 0 0 0] )\nbot( name \"r1\" pose [9 0 0 90] )\n",
                           {.sensors = sensors::world_file_words()});
    Simulation simulation(world, host_device(), {.seed = 9, .actor = {{.name = "wander"}, {}}});
    record::Recorder recorder(path(name), run_info(world, simulation.farm().sensor_set(), {9, readings}));
    for (int tick = 0; tick < 20; ++tick) recorder.write(simulation.step());
    recorder.finish();
    return record::open_recording(path(name));
  }
  DeriveFile file(const std::string& text) const { return read_derive_file(write("with.toml", text)); }
};

DerivedSource source_of(record::Recording recording, const DeriveFile& file = {}) {
  DerivedSource source;
  source.recording = std::move(recording);
  source.world = recorded_world(source.recording);
  add_sensors(file.file, file.derived, source.world);
  return source;
}

/// Readings of derived sensors by time, mover, type and number.
using Derived = std::map<std::tuple<std::int64_t, std::uint32_t, int, std::uint32_t>, std::vector<double>>;

struct Kept final : base::Sink {
  void write(const base::TickRecord& record) override {
    for (const base::ReadingBlock& r : record.readings)
      if (sensors::find_sensor_type(r.type)->derived != nullptr)
        readings[{r.time, r.mover, r.type, r.sensor}].assign(r.values.begin(), r.values.end());
  }
  Derived readings;
};

Derived recorded_derived(const record::Recording& recording) {
  Derived kept;
  for (const record::ReadingSample& r : recording.readings)
    if (sensors::find_sensor_type(r.type)->derived != nullptr) kept[{r.time, r.mover, r.type, r.sensor}] = r.values;
  return kept;
}

Derived derived(const DerivedSource& source, unsigned threads = 1) {
  Kept kept;
  replay_derived(source, kept, {.threads = threads});
  return kept.readings;
}

/// Equal bits, and NaN equals NaN.
void expect_same(const Derived& ours, const Derived& theirs) {
  ASSERT_EQ(ours.size(), theirs.size());
  for (const auto& [key, values] : theirs) {
    ASSERT_TRUE(ours.contains(key)) << std::get<0>(key);
    ASSERT_TRUE(std::ranges::equal(ours.at(key), values,
                                   [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }))
        << std::get<0>(key) << " ns";
  }
}

constexpr const char* kInWorld =
    "derived( name \"pose\" type \"localization\" inputs [\"encoder\" \"gyro\" \"gps\"] rate 29 latency 0.05 )\n"
    "derived( name \"late\" type \"localization\" inputs [\"localization:0\"] rate 13 phase 0.01 noise [0.1 2] )\n";
constexpr const char* kInFile =
    "[[derived]]\nrobot = \"*\"\ntype = \"localization\"\nname = \"pose\"\ninputs = [\"encoder\", \"gyro\", \"gps\"]\n"
    "rate = 29\nlatency = 0.05\n"
    "[[derived]]\nrobot = \"*\"\ntype = \"localization\"\nname = \"late\"\ninputs = [\"localization:0\"]\nrate = 13\n"
    "phase = 0.01\nnoise = [0.1, 2]\n";

/// As if the sensors had been in the world of the run.
TEST_F(DerivedReplayTest, NewSensorsHaveTheBytesOfTheRun) {
  const record::Recording with = run("with", kInWorld), without = run("without", "");
  ASSERT_GT(recorded_derived(with).size(), 100u);
  ASSERT_TRUE(recorded_derived(without).empty());
  expect_same(derived(source_of(without, file(kInFile))), recorded_derived(with));
}

TEST_F(DerivedReplayTest, RecordedSensorsAreRecomputedBitByBit) {
  DerivedSource source = source_of(run("with", kInWorld));
  Kept kept;
  const DerivedReplay replay = replay_derived(source, kept, {});
  EXPECT_EQ(replay.equal, recorded_derived(source.recording).size());
  EXPECT_EQ(replay.different, 0u);
  EXPECT_EQ(replay.inputs + replay.equal, source.recording.readings.size());
  const auto gyro = std::ranges::find_if(source.recording.readings, [](const record::ReadingSample& r) {
    return r.type == sensors::kGyro && r.time > base::nanoseconds(0.5);
  });
  gyro->values[0] += 1e-6;
  EXPECT_GT(replay_derived(source, kept, {}).different, 10u) << "each input counts";
}

constexpr const char* kLinks =
    "[[derived]]\nrobot = \"r0\"\ntype = \"link-speed\"\nname = \"speed\"\ninputs = [\"*/gps\"]\nrate = 1\nreach = 20\n"
    "links = 2\n";

TEST_F(DerivedReplayTest, ListsOfListsAreNumberedKeys) {
  const record::Recording recording = run("without", "");
  const auto speeds = [&](const std::string& links) { return derived(source_of(recording, file(kLinks + links))); };
  const Derived numbered = speeds("\"link[0]\" = [-9, 0, 9, 0]\n\"link[1]\" = [9, -5, 9, 5]\n");
  EXPECT_EQ(numbered.size(), 2u);
  expect_same(speeds("link = [[-9, 0, 9, 0], [9, -5, 9, 5]]\n"), numbered);
}

TEST_F(DerivedReplayTest, SensorsThatWereNeverValidAreNamed) {
  const auto lines = [&](const std::string& rate) {
    const DerivedSource source = source_of(
        run("run" + rate, ""),
        file("[[derived]]\nrobot = \"r1\"\ntype = \"aggregate\"\nname = \"x\"\ninputs = [\"gps\"]\nquantity = \"x_m\"\n"
             "rate = 10\nmax_age = " +
             rate));
    Kept kept;
    return replay_derived(source, kept, {}).never_valid;
  };
  EXPECT_EQ(lines("0.2"), std::vector<std::string>());
  EXPECT_EQ(lines("0.1"), std::vector<std::string>{"none of the 20 readings of aggregate 'x' of 'r1' was valid"})
      << "satellite positions are 0.11 s late";
}

TEST_F(DerivedReplayTest, ThreadsAndRepetitionsDoNotChangeAByte) {
  const DerivedSource source = source_of(run("without", ""), file(kInFile));
  std::vector<std::string> bytes;
  for (const unsigned threads : {1u, 3u, 3u}) {
    const std::string folder = path("out" + std::to_string(bytes.size()));
    record::Recorder recorder(folder, derived_run_info(source));
    replay_derived(source, recorder, {.threads = threads});
    recorder.finish();
    std::ifstream in(folder + "/run.mcap", std::ios::binary);
    bytes.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  EXPECT_GT(bytes[0].size(), 1000u);
  EXPECT_EQ(bytes[0], bytes[1]);
  EXPECT_EQ(bytes[0], bytes[2]);
}

/// The result is a recording like any other.
TEST_F(DerivedReplayTest, DerivedRecordingsAreRecordings) {
  const DerivedSource source = source_of(run("without", ""), file(kInFile));
  record::Recorder recorder(path("out"), derived_run_info(source));
  replay_derived(source, recorder, {});
  recorder.finish();
  const record::Recording out = record::open_recording(path("out"));
  EXPECT_TRUE(out.damage.empty());
  EXPECT_EQ(out.ticks, 20u);
  expect_same(derived(source_of(out)), recorded_derived(out));
  EXPECT_EQ(out.states[1][19].X_WM.x, source.recording.states[1][19].X_WM.x);
}

TEST_F(DerivedReplayTest, RefusalsNameTheRemedy) {
  const auto refusal = [&](const std::string& text, bool readings = true) {
    return refusal_of([&] { derived(source_of(run("run", "", readings), file(text))); });
  };
  const std::string one = "[[derived]]\nrobot = \"r0\"\nname = \"pose\"\ntype = \"localization\"\n";
  expect_in("record the run with --record-readings", refusal(one + "inputs = [\"gps\"]", false));
  expect_in("no derived sensors: list them as [[derived]]", refusal("[[input]]\nrobot = \"a\"\ntopic = \"/b\"\n"));
  expect_in("with.toml:1: the recording has no robot 'r2'; did you mean 'r0'?",
            refusal("[[derived]]\nrobot = \"r2\"\nname = \"pose\"\ntype = \"localization\"\ninputs = [\"gps\"]"));
  expect_in("with.toml:1: localization 'pose' of 'r0': no robot of this world has a sensor of type 'gsp'",
            refusal(one + "inputs = [\"gsp\"]"));
  expect_in("with.toml:1: unknown property 'nois'", refusal(one + "inputs = [\"gps\"]\nnois = 3"));
  expect_in("'r0' already has a sensor called 'gps:0'",
            refusal("[[derived]]\nrobot = \"r0\"\nname = \"gps:0\"\ntype = \"localization\"\ninputs = [\"gps\"]"));
  expect_in("with.toml:1: expected type = \"...\"", refusal("[[derived]]\nrobot = \"r0\"\nname = \"a\""));
  expect_in("did you mean 'localization'?",
            refusal("[[derived]]\nrobot = \"r0\"\nname = \"a\"\ntype = \"localisation\"\ninputs = [\"gps\"]"));
}

TEST_F(DerivedReplayTest, DamagedRecordingsAreRefused) {
  DerivedSource source = source_of(run("with", kInWorld));
  const auto refusal = [](const DerivedSource& damaged) { return refusal_of([&] { derived(damaged); }); };
  DerivedSource damaged = source;
  damaged.recording.readings[7].values.push_back(1.0);
  expect_in("does not fit its world", refusal(damaged));
  damaged = source;
  damaged.recording.readings[7].sensor = 9;
  expect_in("does not fit its world", refusal(damaged));
  damaged = source;
  for (auto& states : damaged.recording.states) states[9].time = states[8].time;
  expect_in("the times of its ticks do not increase", refusal(damaged));
  damaged = source;
  for (auto& states : damaged.recording.states) states[19].time = INT64_MAX / 2;
  expect_in("more than a billion readings", refusal(damaged));
  damaged = source;
  damaged.recording.states[1].pop_back();
  expect_in("no ticks with the states of all movers", refusal(damaged));
}

/// Messages of another program, from 1e18 ns on, logged 20 ms after their stamps.
class Bag {
 public:
  void add(std::string_view type, const std::string& topic, double time,
           const std::function<void(std::int64_t, base::Bytes&)>& encode) {
    auto& channel = channels_[topic];
    if (channel == 0)
      channel = mcap_.add_channel(mcap_.add_schema(type, "ros2msg", record::schema_text(type)), topic, "cdr");
    const std::int64_t stamp = kZero + base::nanoseconds(time);
    base::Bytes bytes;
    encode(stamp, bytes);
    messages_.push_back({channel, stamp + 20'000'000, std::move(bytes)});
  }
  std::string text() {
    for (const Message& m : messages_)
      mcap_.add_message({m.channel, 0, static_cast<std::uint64_t>(m.log), static_cast<std::uint64_t>(m.log), m.bytes});
    mcap_.finish();
    return {mcap_.pending().begin(), mcap_.pending().end()};
  }
  static constexpr std::int64_t kZero = 1'300'000'000 * base::kSecond;

 private:
  struct Message {
    std::uint16_t channel;
    std::int64_t log;
    base::Bytes bytes;
  };
  record::McapWriter mcap_{"ros2", "test"};
  std::map<std::string, std::uint16_t> channels_;
  std::vector<Message> messages_;
};

/// A robot that drives along a circle of 10 m at 1 m/s for ten seconds, near Erlangen.
std::string circle(double covariance = 0.04) {
  Bag bag;
  for (int k = 0; k <= 500; ++k)
    bag.add(record::kImu, "/imu", 0.02 * k, [&](std::int64_t time, base::Bytes& out) {
      record::encode_standard({.message = record::StandardTopic::Message::imu}, time, std::vector<double>{0.1}, out);
    });
  for (int k = 0; k <= 100; ++k)
    bag.add(record::kOdometry, "/odom", 0.1 * k, [&](std::int64_t time, base::Bytes& out) {
      const double yaw = 0.01 * k;
      record::encode_odometry({time, "odom", "base", {10 * std::sin(yaw), 10 - 10 * std::cos(yaw), 0, yaw}},
                              {1, 0, 0.1}, {.pose = {covariance, 0, 0, covariance, 0, covariance}}, out);
    });
  for (int k = 0; k <= 10; ++k)
    bag.add(record::kNavSatFix, "/fix", k, [&](std::int64_t time, base::Bytes& out) {
      const double yaw = 0.1 * k;
      record::encode_standard({.message = record::StandardTopic::Message::fix, .sigma = covariance > 0 ? 0.5 : 0.0},
                              time, std::vector<double>{10 * std::sin(yaw), 10 - 10 * std::cos(yaw), 1.2, 8}, out);
    });
  for (int k = 0; k <= 5; ++k)
    bag.add(record::kLaserScan, "/scan", k, [&](std::int64_t time, base::Bytes& out) {
      record::encode_scan({.time = time, .frame = "laser", .fov = 2.0F, .range_min = 0.1, .range_max = 8.0},
                          std::vector<double>{1, 2, 8}, out);
    });
  return bag.text();
}

constexpr const char* kInputs =
    "[[input]]\nrobot = \"car\"\ntopic = \"/imu\"\nnoise = 0.1\n"
    "[[input]]\nrobot = \"car\"\ntopic = \"/odom\"\n"
    "[[input]]\nrobot = \"car\"\ntopic = \"/fix\"\n"
    "[[input]]\nrobot = \"car\"\ntopic = \"/scan\"\npose = [0.2, 0, 0, 90]\n";

TEST_F(DerivedReplayTest, ForeignMessagesBecomeSensors) {
  const DerivedSource source = read_foreign(write("drive.mcap", circle()), file(kInputs));
  ASSERT_EQ(source.world.movers.size(), 1u);
  std::map<int, std::vector<record::ReadingSample>> by_type;
  for (const record::ReadingSample& reading : source.recording.readings) by_type[reading.type].push_back(reading);
  ASSERT_EQ(by_type.size(), 4u);
  ASSERT_EQ(by_type[sensors::kGyro].size(), 501u);
  EXPECT_EQ(by_type[sensors::kGyro][3].values, std::vector<double>{0.1});
  EXPECT_EQ(by_type[sensors::kGyro][3].time, 60'000'000);
  EXPECT_EQ(by_type[sensors::kGyro][3].delivered, 80'000'000);
  EXPECT_EQ(by_type[sensors::kGyro][3].sequence, 3u);
  const auto& fix = by_type[sensors::kGps][5].values;
  EXPECT_NEAR(fix[0], 10 * std::sin(0.5), 1e-6);
  EXPECT_NEAR(fix[1], 10 - 10 * std::cos(0.5), 1e-6);
  EXPECT_NEAR(fix[2], 0.6, 1e-9) << "the receiver's noise is 1 m: HDOP states the fix's own";
  EXPECT_EQ(by_type[sensors::kLaser][0].values, (std::vector<double>{1, 2, 8}));
  const sensors::SensorSet all(source.world);
  EXPECT_EQ(all.of(sensors::kLaser, 0)[0].elements, 3u);
  EXPECT_NEAR(all.of(sensors::kLaser, 0)[0].fov, 2.0, 1e-6);
  EXPECT_NEAR(all.of(sensors::kLaser, 0)[0].X_MS.yaw, M_PI / 2, 1e-9);
  EXPECT_EQ(source.recording.info.options.back().second, std::to_string(Bag::kZero));
}

TEST_F(DerivedReplayTest, ForeignMessagesAreLocalized) {
  const DeriveFile with = file(std::string(kInputs) +
                               "[[derived]]\nrobot = \"car\"\nname = \"pose\"\ntype = \"localization\"\nrate = 20\n"
                               "inputs = [\"gyro\", \"odometry\", \"gps\"]\n");
  DerivedSource source = read_foreign(write("drive.mcap", circle()), with);
  add_sensors(with.file, with.derived, source.world);
  const Derived once = derived(source), again = derived(source, 3);
  expect_same(once, again);
  ASSERT_GT(once.size(), 200u);
  const std::vector<double>& last = once.at({10 * base::kSecond, 0, sensors::kLocalization, 0});
  EXPECT_EQ(last[3], 1.0);
  EXPECT_NEAR(last[0], 10 * std::sin(1.0), 0.2);
  EXPECT_NEAR(last[1], 10 - 10 * std::cos(1.0), 0.2);
  EXPECT_NEAR(last[2], 1.0, 0.05);
  EXPECT_LT(last[4], 0.04) << "less than the variance of a single input";
}

TEST_F(DerivedReplayTest, TablesBecomeSensors) {
  write("wheels.csv",
        "t_ms,w_left_m,w_right_m,turn_rad_s,note\n0,0,0,0.5,a\n\n100,0.1,0.2,,\"b,c\"\n50,0.05,0.1,0.25,\n");
  const DeriveFile with = file(
      "[[input]]\nrobot = \"car\"\nfile = \"wheels.csv\"\ntime = \"t_ms\"\nas = \"gyro\"\n"
      "columns = { rate_rad_s = \"turn_rad_s\" }\n"
      "[[input]]\nrobot = \"car\"\nfile = \"wheels.csv\"\ntime = \"t_ms\"\nas = \"rolled\"\n"
      "columns = { left_m = \"w_left_m\", right_m = \"w_right_m\" }\n");
  const DerivedSource source = read_foreign(folder_.string(), with);
  ASSERT_EQ(source.recording.readings.size(), 6u);
  const record::ReadingSample& middle = source.recording.readings[2];
  EXPECT_EQ(middle.time, 50'000'000);
  EXPECT_EQ(middle.values, std::vector<double>{0.25});
  EXPECT_EQ(source.recording.readings[5].values, (std::vector<double>{0.1, 0.2}));
  EXPECT_TRUE(std::isnan(source.recording.readings[4].values[0])) << "an empty field is unknown";
  EXPECT_EQ(sensors::find_sensor_type(source.recording.readings[5].type)->name, "rolled");
}

TEST_F(DerivedReplayTest, ForeignRefusalsNameWhatExists) {
  const std::string bag = write("drive.mcap", circle(0.0));
  write("a.csv", "time_s,turn_deg_s\n0,1\n1,x\n");
  write("b.csv", "time_s,rate_rad_s\n0,1\n1,x\n");
  const auto refusal = [&](const std::string& input, const std::string& place = "") {
    return refusal_of([&] { read_foreign(place.empty() ? bag : place, file("[[input]]\nrobot = \"car\"\n" + input)); });
  };
  expect_in("has no topic '/im'; it has /fix (sensor_msgs/msg/NavSatFix), /imu (sensor_msgs/msg/Imu)",
            refusal("topic = \"/im\""));
  expect_in("add noise = 2", refusal("topic = \"/fix\""));
  EXPECT_EQ(refusal("topic = \"/fix\"\nnoise = 2"), "");
  expect_in("has no column 'x_m' for 'x_m' of gps; it has rate_rad_s", refusal("topic = \"/imu\"\nas = \"gps\""));
  expect_in("cannot be read as laser", refusal("topic = \"/odom\"\nas = \"laser\"\ncolumns = { range_m = \"valid\" }"));
  expect_in("expected topic = \"/NAME\" or file", refusal("as = \"gyro\"", folder_.string()));
  expect_in("'turn_deg_s' of " + path("a.csv") + " is in deg_s, but 'rate_rad_s' of gyro needs rad_s",
            refusal("file = \"a.csv\"\nas = \"gyro\"\ncolumns = { rate_rad_s = \"turn_deg_s\" }"));
  expect_in("a.csv has no column 'when'", refusal("file = \"a.csv\"\nas = \"gyro\"\ntime = \"when\""));
  expect_in("b.csv:3: 'rate_rad_s' expects a number; got 'x'", refusal("file = \"b.csv\"\nas = \"gyro\""));
  write("b.csv", "time_s,rate_rad_s\n0,1\n1\n2,3\n");
  expect_in("b.csv:3: has 1 fields; expected 2", refusal("file = \"b.csv\"\nas = \"gyro\""));
  expect_in("no such recording", refusal("topic = \"/imu\"", path("none.mcap")));
  expect_in("not an MCAP file", refusal("topic = \"/imu\"", path("b.csv")));
  expect_in("robot \"a b\"", refusal_of([&] { file("[[input]]\nrobot = \"a b\"\ntopic = \"/imu\"\n"); }));
}

}  // namespace
}  // namespace sf::scenarios
