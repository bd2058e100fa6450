// A recording played back as ticks.

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "scenarios/replay.h"

namespace sf::scenarios {

namespace {

constexpr std::int64_t kStep = 100;  // [ns]

/// Two robots over four ticks; the first one's only sensor is read in ticks 0 and 2.
record::Recording small_recording() {
  record::Recording recording;
  recording.file = "run.mcap";
  recording.info.sensor_types = {{6, "bumper", "", {{"pressed", 1, true}}, false}};
  recording.info.movers = {{"a", "a", 1, {}}, {"b", "b", 2, {}}};
  recording.info.movers[0].sensors = {{6, "bumper", "/a/bumper/bumper"}};
  recording.states.resize(2);
  for (std::uint64_t tick = 0; tick < 4; ++tick)
    for (std::size_t mover = 0; mover < 2; ++mover)
      recording.states[mover].push_back({tick,
                                         static_cast<std::int64_t>(tick) * kStep,
                                         mover == 1 && tick == 3,
                                         {static_cast<double>(tick), static_cast<double>(mover)},
                                         {},
                                         {0.5}});
  recording.readings = {{0, 6, 0, 0, 0, 0, 1, {7.0}}, {0, 6, 0, 1, 2 * kStep, 2 * kStep, 1, {8.0}}};
  return recording;
}

double read_value(const base::TickRecord& tick) {
  return tick.readings.size() == 1 ? tick.readings[0].values[0] : -static_cast<double>(tick.readings.size());
}

}  // namespace

TEST(Replay, FindsTicksByTime) {
  const record::Recording recording = small_recording();
  const Replay replay(recording, recording.info);
  EXPECT_EQ(replay.ticks(), 4u);
  EXPECT_EQ(replay.start(), 0);
  EXPECT_EQ(replay.end(), 3 * kStep);
  EXPECT_EQ(replay.tick_at(-1), 0u);            // before the first
  EXPECT_EQ(replay.tick_at(kStep - 1), 0u);     // just before a tick
  EXPECT_EQ(replay.tick_at(kStep), 1u);         // at a tick
  EXPECT_EQ(replay.tick_at(1000 * kStep), 3u);  // after the last
}

TEST(Replay, ReturnsStatesAndReadingsSinceTheShownTick) {
  const record::Recording recording = small_recording();
  Replay replay(recording, recording.info);
  const base::TickRecord last = replay.tick(3, 2);
  EXPECT_EQ(last.time, 3 * kStep);
  ASSERT_EQ(last.reports.size(), 2u);
  EXPECT_EQ(last.reports[1].mover, 1u);
  EXPECT_EQ(last.reports[1].X_WM.x, 3.0);
  EXPECT_EQ(last.contacts[0], 0);
  EXPECT_EQ(last.contacts[1], 1);
  EXPECT_EQ(last.commands[1].forward, 0.5);
  EXPECT_EQ(read_value(last), 0.0) << "none since tick 2";
  EXPECT_EQ(read_value(replay.tick(2, 1)), 8.0);
  EXPECT_EQ(read_value(replay.tick(3, 0)), 8.0) << "of the ticks between, too";
}

/// Sensors also measure between ticks; their poses are not recorded.
TEST(Replay, ReturnsThePoseOfASensorAtItsMeasurement) {
  record::Recording recording = small_recording();
  recording.info.movers[0].sensors[0].X_MS = {0.5, 0.0, 0.0, 0.0};
  recording.states[0][1].X_WM.yaw = 3.0;
  recording.states[0][2].X_WM.yaw = -3.0;  // 0.28 rad across pi
  const auto pose_at = [&](std::int64_t time) {
    recording.readings = {{0, 6, 0, 0, 3 * kStep, time, 1, {7.0}}};
    Replay replay(recording, recording.info);
    const base::ReadingBlock& reading = replay.tick(3, 2).readings[0];
    EXPECT_NEAR(reading.X_WS.x, reading.X_WM.x + 0.5 * std::cos(reading.X_WM.yaw), 1e-12);
    return reading.X_WM;
  };
  EXPECT_EQ(pose_at(kStep).x, 1.0);                                // at a tick
  EXPECT_NEAR(pose_at(3 * kStep / 2).x, 1.5, 1e-12);               // between two
  EXPECT_NEAR(std::cos(pose_at(3 * kStep / 2).yaw), -1.0, 1e-12);  // the shorter way around
  EXPECT_EQ(pose_at(-5).x, 0.0);                                   // before the first
  EXPECT_EQ(pose_at(9 * kStep).x, 3.0);                            // after the last
}

TEST(Replay, ReturnsEachSensorsNewestReadingAfterAJump) {
  const record::Recording recording = small_recording();
  Replay replay(recording, recording.info);
  EXPECT_EQ(read_value(replay.tick(1, std::nullopt)), 7.0);
  EXPECT_EQ(read_value(replay.tick(3, std::nullopt)), 8.0);
  EXPECT_EQ(read_value(replay.tick(1, 3)), 7.0) << "backwards";
}

TEST(Replay, SkipsReadingsOfOtherForms) {
  record::Recording recording = small_recording();
  record::RunInfo info = recording.info;
  recording.readings.push_back({0, 6, 1, 0, 0, 0, 1, {1.0}});       // unknown sensor
  recording.readings.push_back({0, 6, 0, 0, 0, 0, 1, {1.0, 2.0}});  // two rows of a type that has one
  recording.readings.push_back({0, 9, 0, 0, 0, 0, 1, {1.0}});       // unknown type
  EXPECT_EQ(Replay(recording, info).left_out(), 3u);
  info.sensor_types[0].columns[0].name = "force_N";  // another version of the type
  EXPECT_EQ(Replay(recording, info).left_out(), 5u);
}

TEST(Replay, SurvivesDamage) {
  record::Recording recording = small_recording();
  recording.states[1].resize(2);       // a mover without its last states
  recording.lights = {{0, {{}, {}}}};  // lights that are not in the world
  Replay replay(recording, recording.info);
  const base::TickRecord last = replay.tick(3, std::nullopt);
  EXPECT_EQ(last.reports.size(), 1u);
  EXPECT_TRUE(last.lights.empty());
}

TEST(Replay, RejectsRecordingsWithoutTicksOrStates) {
  record::Recording empty = small_recording();
  for (auto& states : empty.states) states.clear();
  EXPECT_THROW(Replay(empty, empty.info), base::InputError);
  record::Recording other = small_recording();
  other.states.pop_back();
  EXPECT_THROW(Replay(other, other.info), base::InputError);
}

}  // namespace sf::scenarios
