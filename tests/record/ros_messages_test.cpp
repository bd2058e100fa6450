#include "record/ros_messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/tilted_pose.h"
#include "record/fleet_message.h"
#include "record/run_info.h"
#include "tests/record/bytes_at.h"
#include "tests/record/sample.h"

namespace sf::record {
namespace {

using base::Bytes;

using test::at;

Scan sample_scan() {
  return {
      .time = 12'000'000'034, .frame = "r/l", .fov = 2.0F, .scan_time = 0.1F, .range_min = 0.25F, .range_max = 8.0F};
}

TEST(Messages, ScanHasTheLayoutOfROS) {
  const double infinity = std::numeric_limits<double>::infinity();
  Bytes out;
  encode_scan(sample_scan(), std::vector<double>{1.0 / 3.0, 8.0, infinity}, out);
  EXPECT_EQ(at<std::int32_t>(out, 4), 12);
  EXPECT_EQ(at<std::uint32_t>(out, 8), 34u);
  EXPECT_EQ(at<std::uint32_t>(out, 12), 4u);  // "r/l" and its terminator
  EXPECT_EQ(std::memcmp(out.data() + 16, "r/l", 4), 0);
  EXPECT_EQ(at<float>(out, 20), -1.0F);  // angle_min
  EXPECT_EQ(at<float>(out, 24), 1.0F);   // angle_max
  EXPECT_EQ(at<float>(out, 28), 1.0F);   // angle_increment: three beams, two gaps
  EXPECT_EQ(at<float>(out, 32), 0.0F);   // time_increment
  EXPECT_EQ(at<float>(out, 36), 0.1F);   // scan_time
  EXPECT_EQ(at<float>(out, 40), 0.25F);
  EXPECT_EQ(at<float>(out, 44), 8.0F);
  EXPECT_EQ(at<std::uint32_t>(out, 48), 3u);
  EXPECT_EQ(at<float>(out, 52), static_cast<float>(1.0 / 3.0));
  EXPECT_EQ(at<float>(out, 56), std::numeric_limits<float>::infinity());  // the largest range means no return (REP 117)
  EXPECT_EQ(at<float>(out, 60), std::numeric_limits<float>::infinity());
  EXPECT_EQ(at<std::uint32_t>(out, 64), 0u);  // no intensities
  EXPECT_EQ(out.size(), 68u);
}

/// Clients compute `angle_min + i * angle_increment`.
TEST(Messages, ScanOfOneBeamPointsAhead) {
  Bytes out;
  encode_scan(sample_scan(), std::vector<double>{1.0}, out);
  EXPECT_EQ(at<float>(out, 20), 0.0F) << "angle_min";
  EXPECT_EQ(at<float>(out, 24), 0.0F) << "angle_max";
  EXPECT_EQ(at<float>(out, 28), 0.0F) << "angle_increment";
  EXPECT_EQ(decode_scan(out)->fov, 0.0F);
}

TEST(Messages, RoundsLimitsOutwardsToFloats) {
  Scan scan = sample_scan();
  scan.range_min = 0.1;  // its nearest float32 is more
  scan.range_max = 0.7;  // its nearest float32 is less
  Bytes out;
  encode_scan(scan, std::vector<double>{0.1, std::nextafter(0.7, 0.0), 0.09}, out);
  const auto back = decode_scan(out);
  ASSERT_TRUE(back);
  EXPECT_LT(back->range_min, 0.1);
  EXPECT_GT(back->range_max, 0.7);
  EXPECT_EQ(back->ranges[0], 0.1F);
  EXPECT_EQ(back->ranges[1], 0.7F);
  EXPECT_EQ(back->ranges[2], -std::numeric_limits<float>::infinity()) << "too near";
}

TEST(Messages, ScanRoundTrips) {
  Bytes out;
  encode_scan(sample_scan(), std::vector<double>{0.5, 7.75}, out);
  const auto scan = decode_scan(out);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->time, 12'000'000'034);
  EXPECT_EQ(scan->frame, "r/l");
  EXPECT_EQ(scan->fov, 2.0F);
  EXPECT_EQ(scan->scan_time, 0.1F);
  EXPECT_EQ(scan->range_min, 0.25F);
  EXPECT_EQ(scan->range_max, 8.0F);
  EXPECT_EQ(scan->ranges, (std::vector<float>{0.5F, 7.75F}));
}

/// The stamp is the time of the first beam; `time` that of the last. A scan that began before time 0 has one time.
TEST(Messages, RollingScansHaveTheTimeOfTheirFirstBeam) {
  Scan scan = sample_scan();
  scan.time_increment = 0.025F;
  Bytes out, first;
  encode_scan(scan, std::vector<double>{1.0, 2.0, 3.0}, out);
  EXPECT_EQ(at<std::int32_t>(out, 4), 11);
  EXPECT_NEAR(at<std::uint32_t>(out, 8), 950'000'034.0, 2.0);
  EXPECT_EQ(at<float>(out, 32), 0.025F);
  EXPECT_EQ(decode_scan(out)->time, scan.time);
  scan.time = 0;
  encode_scan(scan, std::vector<double>{1.0, 2.0, 3.0}, first);
  EXPECT_EQ(at<float>(first, 32), 0.0F);
  EXPECT_EQ(decode_scan(first)->time, 0);
}

TEST(Messages, RejectsEveryTruncation) {
  const test::SampleTick tick(3);
  RunInfo info = test::sample_info(true);
  name_frames(info);
  Bytes scan, fleet, run;
  encode_scan(sample_scan(), std::vector<double>{0.5, 8.0}, scan);
  encode_fleet(tick.record, fleet);
  encode_run_info(info, run);
  FleetState state;
  for (std::size_t size = 0; size < scan.size(); ++size) EXPECT_FALSE(decode_scan(std::span(scan).first(size)));
  for (std::size_t size = 0; size < fleet.size(); ++size)
    EXPECT_FALSE(decode_fleet(std::span(fleet).first(size), state));
  for (std::size_t size = 0; size < run.size(); ++size) EXPECT_FALSE(decode_run_info(std::span(run).first(size), info));
}

TEST(Messages, OdometryHasTheLayoutOfROS) {
  Bytes out;
  encode_odometry({1'500'000'000, "world", "r", {1.0, 2.0, 3.0, M_PI / 2}}, {0.5, -0.25, 0.125},
                  {{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, {7.0, 8.0, 9.0}, 0.5}, out);
  // 4 + stamp 8 + "world" 4 + 6 | 22 -> 24: "r" 4 + 2 | 30 -> 36: the pose, 8-aligned after the encapsulation
  EXPECT_EQ(at<std::uint32_t>(out, 8), 500'000'000u);
  EXPECT_EQ(std::memcmp(out.data() + 16, "world", 6), 0);
  EXPECT_EQ(std::memcmp(out.data() + 28, "r", 2), 0);
  EXPECT_EQ(at<double>(out, 36), 1.0);
  EXPECT_EQ(at<double>(out, 44), 2.0);
  EXPECT_EQ(at<double>(out, 52), 3.0);
  EXPECT_EQ(at<double>(out, 60), 0.0);                    // x
  EXPECT_EQ(at<double>(out, 68), 0.0);                    // y
  EXPECT_DOUBLE_EQ(at<double>(out, 76), std::sqrt(0.5));  // z
  EXPECT_DOUBLE_EQ(at<double>(out, 84), std::sqrt(0.5));  // w
  const auto covariance = [&](std::size_t begin, std::size_t row, std::size_t column) {
    return at<double>(out, begin + 8 * (6 * row + column));
  };
  const double pose[3][3] = {{1.0, 2.0, 3.0}, {2.0, 4.0, 5.0}, {3.0, 5.0, 6.0}};  // x, y and the rotation about z
  for (const std::size_t i : {0, 1, 2})
    for (const std::size_t j : {0, 1, 2}) EXPECT_EQ(covariance(92, i == 2 ? 5 : i, j == 2 ? 5 : j), pose[i][j]);
  for (const std::size_t axis : {2, 3, 4}) EXPECT_EQ(covariance(92, axis, axis), 0.5);
  const std::size_t twist = 92 + 36 * 8;
  for (const auto& [row, column, value] : {std::tuple{0, 0, 7.0}, {0, 5, 8.0}, {5, 0, 8.0}, {5, 5, 9.0}, {1, 1, 0.5}})
    EXPECT_EQ(covariance(twist + 48, row, column), value);
  EXPECT_EQ(at<double>(out, twist), 0.5);
  EXPECT_EQ(at<double>(out, twist + 8), -0.25);
  EXPECT_EQ(at<double>(out, twist + 40), 0.125);
  EXPECT_EQ(out.size(), twist + 48 + 36 * 8);
}

TEST(Messages, PosesOfTiltedRobotsHaveWholeQuaternions) {
  const base::Tilt tilt{0.3, -0.2};
  const base::Quaternion q = base::quaternion_of(0.7, tilt);
  Bytes odometry, transforms;
  encode_odometry({0, "world", "r", {1.0, 2.0, 3.0, 0.7}, tilt}, {}, {}, odometry);
  encode_transforms(std::vector<Transform>{{0, "abc", "xyz", {1.0, 2.0, 3.0, 0.7}, tilt}}, transforms);
  for (const Bytes* message : {&odometry, &transforms})  // both have the position at byte 36
    for (const auto& [k, value] : {std::pair{0, 1.0}, {2, 3.0}, {3, q.x}, {4, q.y}, {5, q.z}, {6, q.w}})
      EXPECT_EQ(at<double>(*message, 36 + 8 * static_cast<std::size_t>(k)), value) << k;
}

/// Only those of movers in the world that are known are in the message.
TEST(Messages, WheelsRoundTripBitwise) {
  test::SampleTick tick(3, 3);
  EXPECT_FALSE(any_wheels(tick.record));
  tick.reports[1].wheels = {0.1f, -2.0f}, tick.reports[2].wheels = {3.0f, 4.0f};
  tick.reports[2].X_WM = base::kAbsent;
  tick.record.reports = tick.reports;
  EXPECT_TRUE(any_wheels(tick.record));
  Bytes out;
  encode_wheels(tick.record, out);
  WheelsSample sample;
  ASSERT_TRUE(decode_wheels(out, sample));
  EXPECT_EQ(sample.time, 300'000'000);
  ASSERT_EQ(sample.movers.size(), 1u);
  EXPECT_EQ(sample.movers[0].mover, 1u);
  EXPECT_EQ(sample.movers[0].value.left, 0.1f);
  EXPECT_EQ(sample.movers[0].value.right, -2.0f);
  for (std::size_t size = 0; size < out.size(); ++size) EXPECT_FALSE(decode_wheels(std::span(out).first(size), sample));
  tick.reports[1].wheels.right = NAN;
  encode_wheels(tick.record, out = {});
  EXPECT_FALSE(decode_wheels(out, sample)) << "encoders count finite ways";
}

/// Only movers in the world that are not level are in the message.
TEST(Messages, TiltsRoundTripBitwise) {
  test::SampleTick tick(3, 4);
  EXPECT_FALSE(any_tilted(tick.record));
  tick.reports[1].tilt = {0.1, -1.0 / 3.0}, tick.reports[2].tilt.pitch = 0.5, tick.reports[3].tilt.roll = 0.5;
  tick.reports[3].X_WM = base::kAbsent;
  tick.record.reports = tick.reports;
  EXPECT_TRUE(any_tilted(tick.record));
  Bytes out;
  encode_tilts(tick.record, out);
  TiltsSample sample;
  ASSERT_TRUE(decode_tilts(out, sample));
  EXPECT_EQ(sample.time, 300'000'000);
  ASSERT_EQ(sample.movers.size(), 2u);
  EXPECT_EQ(sample.movers[0].mover, 1u);
  EXPECT_EQ(sample.movers[0].value.pitch, -1.0 / 3.0);
  EXPECT_EQ(sample.movers[1].mover, 2u);
  EXPECT_EQ(sample.movers[1].value.pitch, 0.5);
  for (std::size_t size = 0; size < out.size(); ++size) EXPECT_FALSE(decode_tilts(std::span(out).first(size), sample));
  tick.reports[2].tilt.pitch = NAN;
  encode_tilts(tick.record, out = {});
  EXPECT_FALSE(decode_tilts(out, sample)) << "the farm requires finite tilts";
}

TEST(Messages, CommandsAndTransformsHaveTheLayoutOfROS) {
  Bytes twist;
  encode_twist(1'500'000'000, "abc", {0.5, -0.25, 0.125}, twist);
  EXPECT_EQ(at<std::int32_t>(twist, 4), 1);
  EXPECT_EQ(at<std::uint32_t>(twist, 8), 500'000'000u);
  EXPECT_EQ(std::memcmp(twist.data() + 16, "abc", 4), 0);
  EXPECT_EQ(at<double>(twist, 20), 0.5);  // stamp 8, string 8: 16 after the encapsulation
  EXPECT_EQ(at<double>(twist, 28), -0.25);
  for (const std::size_t zero : {36, 44, 52}) EXPECT_EQ(at<double>(twist, zero), 0.0) << zero;
  EXPECT_EQ(at<double>(twist, 60), 0.125);
  EXPECT_EQ(twist.size(), 68u);

  Bytes transforms;
  const std::vector<Transform> two = {{2'000'000'003, "abc", "xyz", {1.0, 2.0, 3.0, 0.0}},
                                      {0, "abc", "xyz", {4.0, 5.0, 6.0, 0.0}}};
  encode_transforms(two, transforms);
  EXPECT_EQ(at<std::uint32_t>(transforms, 4), 2u);
  EXPECT_EQ(at<std::int32_t>(transforms, 8), 2);
  EXPECT_EQ(at<std::uint32_t>(transforms, 12), 3u);
  EXPECT_EQ(std::memcmp(transforms.data() + 20, "abc", 4), 0) << "parent";
  EXPECT_EQ(std::memcmp(transforms.data() + 28, "xyz", 4), 0) << "child";
  EXPECT_EQ(at<double>(transforms, 36), 1.0);  // count 4, stamp 8, strings 16: 28 -> 32 after the encapsulation
  EXPECT_EQ(at<double>(transforms, 44), 2.0);
  EXPECT_EQ(at<double>(transforms, 52), 3.0);
  EXPECT_EQ(at<double>(transforms, 84), 1.0);   // w
  EXPECT_EQ(at<double>(transforms, 116), 4.0);  // 88 + stamp 8, strings 16: 112 after the encapsulation
}

TEST(Messages, ClockAndStateQualityHaveTheirLayout) {
  Bytes clock;
  encode_clock(3'000'000'021, clock);
  EXPECT_EQ(at<std::int32_t>(clock, 4), 3);
  EXPECT_EQ(at<std::uint32_t>(clock, 8), 21u);
  EXPECT_EQ(clock.size(), 12u);

  base::StateQuality quality;
  quality.stale = true;
  quality.age = 250'000'000;
  for (std::size_t i = 0; i < quality.covariance.size(); ++i) quality.covariance[i] = 0.5F + static_cast<float>(i);
  Bytes out;
  encode_state_quality(5'000'000'006, "abc", quality, out);
  EXPECT_EQ(at<std::int32_t>(out, 4), 5);
  EXPECT_EQ(at<std::uint32_t>(out, 8), 6u);
  EXPECT_EQ(std::memcmp(out.data() + 16, "abc", 4), 0);
  EXPECT_EQ(at<std::uint8_t>(out, 20), 1);  // stamp 8, string 8: 16 after the encapsulation
  EXPECT_EQ(at<double>(out, 28), 0.25);     // [s], 8-aligned
  for (std::size_t i = 0; i < quality.covariance.size(); ++i)
    EXPECT_EQ(at<float>(out, 36 + 4 * i), 0.5F + static_cast<float>(i)) << i;
  EXPECT_EQ(out.size(), 36 + 4 * quality.covariance.size());
}

TEST(Messages, FleetRoundTripsBitwise) {
  const test::SampleTick tick(3);
  Bytes out;
  encode_fleet(tick.record, out);
  FleetState fleet;
  ASSERT_TRUE(decode_fleet(out, fleet));
  EXPECT_EQ(fleet.tick, 3u);
  EXPECT_EQ(fleet.time, 300'000'000);
  ASSERT_EQ(fleet.states.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const MoverState& state = fleet.states[i];
    EXPECT_EQ(state.mover, i);
    EXPECT_EQ(state.contact, tick.contacts[i] != 0);
    EXPECT_EQ(std::memcmp(&state.X_WM, &tick.reports[i].X_WM, sizeof(base::Pose)), 0);
    EXPECT_EQ(std::memcmp(&state.velocity, &tick.reports[i].velocity, sizeof(base::Twist)), 0);
    EXPECT_EQ(std::memcmp(&state.command, &tick.commands[i], sizeof(base::Twist)), 0);
  }
}

TEST(Messages, FleetWithoutCommandsAndContactsContainsZeros) {
  test::SampleTick tick(3);
  tick.record.commands = {};
  tick.record.contacts = {};
  Bytes out;
  encode_fleet(tick.record, out);
  FleetState fleet;
  ASSERT_TRUE(decode_fleet(out, fleet));
  EXPECT_FALSE(fleet.states[0].contact || fleet.states[1].contact);
  EXPECT_EQ(fleet.states[1].command.forward, 0.0);
}

TEST(Messages, RunInfoRoundTrips) {
  RunInfo info = test::sample_info(true);
  name_frames(info);
  Bytes out;
  encode_run_info(info, out);
  RunInfo back;
  ASSERT_TRUE(decode_run_info(out, back));
  EXPECT_EQ(back.world, "a world");
  EXPECT_EQ(back.world_hash, info.world_hash);
  EXPECT_EQ(back.seed, 42u);
  EXPECT_EQ(back.mode, "exact");
  EXPECT_EQ(back.interval, 0.1);
  EXPECT_TRUE(back.record_readings);
  EXPECT_EQ(back.odometry_rate, 5.0);
  EXPECT_EQ(back.options, info.options);
  ASSERT_EQ(back.movers.size(), 2u);
  EXPECT_EQ(back.movers[0].name, "roomba:1");
  EXPECT_EQ(back.movers[0].base_frame, "roomba_1/base_link");
  EXPECT_EQ(back.movers[1].id, 9u);
  ASSERT_EQ(back.sensor_types.size(), 3u);
  EXPECT_TRUE(back.sensor_types[0].is_scan);
  EXPECT_EQ(back.sensor_types[1].id, 2);
  EXPECT_EQ(back.sensor_types[1].list, "");
  EXPECT_EQ(back.sensor_types[2].name, "array");
  EXPECT_EQ(back.sensor_types[2].list, "elements");
  ASSERT_EQ(back.sensor_types[2].columns.size(), 3u);
  EXPECT_EQ(back.sensor_types[2].columns[1].name, "vector_T");
  EXPECT_EQ(back.sensor_types[2].columns[1].width, 3u);
  EXPECT_TRUE(back.sensor_types[2].columns[2].whole);
  ASSERT_EQ(back.movers[0].sensors.size(), 5u);
  EXPECT_EQ(back.movers[0].sensors[0].type, 1);
  EXPECT_EQ(back.movers[0].sensors[0].X_MS.yaw, 0.3);
  EXPECT_EQ(back.movers[0].sensors[0].samples, 4u);
  EXPECT_EQ(back.movers[0].sensors[1].range_min, 0.5);
  EXPECT_EQ(back.movers[0].sensors[1].rate, 5.0);
  EXPECT_EQ(back.movers[0].sensors[2].X_MS.x, 0.5);
  EXPECT_EQ(back.movers[0].sensors[3].type, 2);
  EXPECT_EQ(back.movers[0].sensors[3].topic, "/roomba_1/edge");
  EXPECT_EQ(back.movers[0].sensors[3].rate, 4.0);
  EXPECT_EQ(back.movers[1].sensors.size(), 1u);
}

/// Rows of lasers do not contain a type: with another type 1, values of any size would be mistaken for its readings.
TEST(Messages, RejectsARunInfoWithAnotherType1) {
  RunInfo info;
  info.sensor_types = {{.id = 1, .name = "laneedge", .columns = {{"distance_m"}}}};
  Bytes out;
  encode_run_info(info, out);
  EXPECT_FALSE(decode_run_info(out, info));
}

TEST(Messages, NegativeTimeAborts) {
  Bytes out;
  EXPECT_DEATH(encode_twist(-1, "r", {}, out), "time -1 ns");
}

}  // namespace
}  // namespace sf::record
