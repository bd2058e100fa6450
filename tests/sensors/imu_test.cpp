// Inertial measurement units: readings at rest and on circles, errors, saturation, states that are carried on, and
// settings that are refused.

#include "sensors/imu.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/tilted_pose.h"
#include "robots/kinematics.h"
#include "sensors/attitude_filter.h"
#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

using sensors::kImu;
constexpr double kG = sensors::kStandardGravity;
constexpr std::int64_t kTick = 100'000'000;  // [ns]

/// A farm with one robot whose readings are taken in ticks and between them.
struct Drive {
  explicit Drive(const std::string& text, std::uint64_t seed = 1, bool noise = true)
      : world(world_of(text)), farm(world, host_device(), {.seed = seed, .noise = noise, .threads = 1}) {
    farm.subscribe_all();
    state.X_WM = world.movers[0].X_WM;
    take(farm.tick(0, {&state, 1}));
  }
  /// Goes on to the next tick, where the robot is at `next`.
  void tick(base::Report next) {
    next.time = state.time + kTick;
    for (std::int64_t due = farm.next_due(); due < next.time; due = farm.next_due())
      take(farm.sample_between(due, {&next, 1}));
    take(farm.tick(next.time, {&next, 1}));
    state = next;
  }
  void drive(const base::Twist& twist) {
    base::Report next = state;
    next.velocity = twist;
    next.X_WM = robots::advance(state.X_WM, twist, 0.1);
    tick(next);
  }
  void take(std::span<const base::ReadingBlock> blocks) {
    for (const base::ReadingBlock& block : blocks) readings.emplace_back(block.values.begin(), block.values.end());
  }

  world::World world;
  farm::Farm farm;
  base::Report state;
  std::vector<std::vector<double>> readings;
};

void expect_near(const std::vector<double>& reading, const std::vector<double>& expected, const char* what) {
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(reading[i], expected[i], 1e-9) << what << " " << i;
}

TEST(Imu, ReadsGravityAtRest) {
  const auto first = [](const std::string& text) { return series(world_of(text), kImu, 1)[0]; };
  expect_near(first("position( imu() )"), {0, 0, 0, 0, 0, kG, 0}, "level");
  expect_near(first("position( pose [3 4 0 50] imu( gravity 1.62 ) )"), {0, 0, 0, 0, 0, 1.62, 0}, "on the Moon");
  const double s = kG * std::sin(0.5), c = kG * std::cos(0.5);
  expect_near(first("unit_angle \"radians\" position( imu( pose6 [1 2 3 0 0.5 1] ) )"), {0, 0, 0, -s, 0, c, 0},
              "nose down");
  expect_near(first("unit_angle \"radians\" position( imu( pose6 [0 0 0 0.5 0 0] ) )"), {0, 0, 0, 0, s, c, 0},
              "left side up");

  const world::World world = world_of("position( imu() )");
  farm::Farm farm(world, host_device(), {});
  const base::ReadingBlock placed = farm.sense(0, kImu, 0, {5, 5, 0, 1}, {0.0, 0.5});
  expect_near({placed.values.begin(), placed.values.end()}, {0, 0, 0, -s, 0, c, 0}, "placed there");
}

/// Starts from rest at once, drives a circle of radius 2 m at 1 m/s with the sensor 0.5 m ahead and turned to the left,
/// and stops at once.
TEST(Imu, IntegratesStartsCirclesAndStops) {
  Drive d("position( imu( rate 40 pose6 [0.5 0 0 0 0 90] ) )");
  for (int k = 0; k < 3; ++k) d.drive({1.0, 0.0, 0.5});
  for (int k = 0; k < 2; ++k) d.drive({});
  ASSERT_EQ(d.readings.size(), 21u) << "one every 25 ms from 0";
  expect_near(d.readings[0], {0, 0, 0, 0, 0, kG}, "before the start");
  // The sensor moves by (1, 0.25) m/s in the robot's frame: (0.25, -1) in its own. It accelerates by (-0.125, 0.5).
  expect_near(d.readings[1], {0, 0, 0.5, 0.5 + 0.25 * 40, 0.125 - 1.0 * 40, kG}, "the start");
  for (std::size_t k = 2; k <= 12; ++k) expect_near(d.readings[k], {0, 0, 0.5, 0.5, 0.125, kG}, "on the circle");
  expect_near(d.readings[13], {0, 0, 0, -0.25 * 40, 1.0 * 40, kG}, "the stop");
  for (std::size_t k = 14; k <= 20; ++k) expect_near(d.readings[k], {0, 0, 0, 0, 0, kG}, "at rest again");
}

TEST(Imu, RelocationsAreNoMotion) {
  Drive d("position( imu( rate 40 ) )");
  d.drive({});
  base::Report there = d.state;
  there.X_WM = {500.0, 0.0, 0.0, 2.0};
  d.tick(there);
  d.drive({});
  for (const auto& reading : d.readings) expect_near(reading, {0, 0, 0, 0, 0, kG}, "relocated");
}

/// Heights are motion, of level movers too: thrown up at 1.96 m/s, in free fall, and caught.
TEST(Imu, FeelsVerticalMotion) {
  for (const double roll : {0.0, 1e-9}) {
    Drive d("position( imu( rate 10 ) )");
    d.state.tilt.roll = roll;
    for (int k = 1; k <= 6; ++k) {
      base::Report next = d.state;
      next.X_WM.z = k < 5 ? 0.5 * kG * 0.01 * k * (5 - k) : 0.0;
      d.tick(next);
    }
    const double up = 0.5 * kG * 0.01 * 4 * 10;
    EXPECT_NEAR(d.readings[1][5], kG + up * 10, 1e-6) << "thrown";
    for (std::size_t k = 2; k <= 5; ++k) EXPECT_NEAR(d.readings[k][5], 0.0, 1e-6) << k << " roll " << roll;
    EXPECT_NEAR(d.readings[6][5], kG + up * 10, 1e-6) << "caught";
  }
}

TEST(Imu, SaturatesAxisByAxis) {
  Drive d("position( imu( rate 10 gyro_range 90 accel_range 9 ) )");
  EXPECT_EQ(d.readings[0][6], 32.0) << "gravity is beyond the range of accelerometer z";
  EXPECT_EQ(d.readings[0][5], 9.0);
  d.drive({1.0, 0.0, -3.0});
  EXPECT_EQ(d.readings[1][2], -M_PI / 2);
  EXPECT_EQ(d.readings[1][6], 4.0 + 8.0 + 32.0) << "gyro z, and accelerometers x and z";
}

TEST(Imu, ErrorsOfARunAreDrawnOnceAndRoundedLast) {
  const char* text =
      "position( imu( gyro_bias 1 gyro_scale 0.1 gyro_misalignment 1 g_sensitivity 1 accel_bias 0.1 "
      "accel_step 0.5 accel_scale 0.01 ) )";
  const auto one = series(world_of(text), kImu, 2, 7), other = series(world_of(text), kImu, 1, 8);
  EXPECT_EQ(one[0], one[1]);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NE(one[0][i], other[0][i]);
  for (std::size_t i = 3; i < 6; ++i) EXPECT_EQ(std::remainder(one[0][i], 0.5), 0.0);
  expect_near(Drive(text, 7, false).readings[0], {0, 0, 0, 0, 0, 10.0, 0}, "without noise, but rounded");
}

/// White noise of gyros and accelerometers has the stated deviation at the rate, and axes are independent.
TEST(Imu, NoiseFollowsTheDensity) {
  const auto readings = series(world_of("position( imu( rate 10 gyro_noise 0.1 accel_noise 0.02 ) )"), kImu, 4000, 3);
  const double sigma[] = {0.1 * M_PI / 180.0 * std::sqrt(10.0), 0.02 * std::sqrt(10.0)};
  std::vector<double> squares(6);
  double cross = 0.0;
  for (const auto& r : readings) {
    for (std::size_t i = 0; i < 6; ++i) squares[i] += std::pow((r[i] - (i == 5 ? kG : 0.0)) / sigma[i / 3], 2) / 4000.0;
    cross += r[0] * r[1] / (sigma[0] * sigma[0]) / 4000.0;
  }
  for (const double square : squares) EXPECT_NEAR(square, 1.0, 0.1) << "4.5 deviations of 4000 squares";
  EXPECT_NEAR(cross, 0.0, 0.07);
}

/// Another process continues with the bytes of the same sensor.
TEST(Imu, ContinuesFromItsState) {
  const char* text = "position( imu( rate 10 preset \"ADIS16470\" gyro_walk 0.01 orientation 1 ) )";
  Drive whole(text), second(text);
  for (int k = 0; k < 4; ++k) whole.drive({1.0, 0.0, 0.3 * k});
  base::Bytes state;
  base::ByteWriter out(state);
  whole.farm.write_sensors(0, out);
  base::ByteReader in(state);
  for (int k = 0; k < 4; ++k) second.drive({});
  second.farm.read_sensors(0, in);
  EXPECT_TRUE(in.good() && in.left() == 0);
  second.state = whole.state;
  whole.drive({0.5, 0.0, 0.1});
  second.drive({0.5, 0.0, 0.1});
  EXPECT_EQ(second.readings.back(), whole.readings.back());
  EXPECT_NE(second.readings.front(), whole.readings.back());
}

/// Readings that nobody has asked for do not change later ones.
TEST(Imu, WandersWhetherItIsReadOrNot) {
  const world::World world = world_of("position( imu( rate 10 gyro_instability 1 gyro_walk 1 gyro_noise 1 ) )");
  farm::Farm farm(world, host_device(), {.seed = 1, .threads = 1});
  const base::Report at_rest{0, 0, world.movers[0].X_WM};
  for (int k = 0; k < 50; ++k) farm.tick(k * kTick, {&at_rest, 1});
  farm.subscribe_all();
  const auto readings = farm.tick(50 * kTick, {&at_rest, 1});
  ASSERT_EQ(readings.size(), 1u);
  EXPECT_EQ(std::vector<double>(readings[0].values.begin(), readings[0].values.end()), series(world, kImu, 51)[50]);
}

/// Without corrections the orientation is that of the integrated rates: the true one.
TEST(Imu, OrientationFollowsTheGyros) {
  Drive d("position( pose [1 2 0 50] imu( rate 40 pose6 [0.5 0 0 10 20 90] orientation 1 gains [0 0] ) )");
  for (int k = 0; k < 12; ++k) d.drive({1.0, 0.2, 2.0 - 0.3 * k});
  const auto X_WS = base::compose(base::transform_of(d.state.X_WM),
                                  sensors::SensorSet(d.world).settings_of<sensors::Imu>(kImu)[0].X_MS);
  const auto& v = d.readings.back();
  ASSERT_EQ(v.size(), 11u);
  const glm::dmat3 R = base::rotation_of(base::Quaternion{v[7], v[8], v[9], v[10]});
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(glm::length(R[k] - X_WS.R[k]), 0.0, 1e-9) << "axis " << k;
}

/// Gravity holds roll and pitch against the biases of gyros, whose z axis turns the heading.
TEST(Imu, GravityCorrectsRollAndPitch) {
  sensors::AttitudeFilter filter(sensors::kAttitudeGain, sensors::kAttitudeBiasGain, kG);
  filter.align(0.5, {0.0, 0.0, kG});
  const glm::dvec3 bias{0.02, -0.01, 0.005}, up{0.0, 0.0, kG};
  double worst = 0.0;
  const auto tilt = [&] { return glm::length(glm::dvec2(filter.q_WS() * glm::dvec3{0.0, 0.0, 1.0})); };
  for (int k = 0; k < 6000; ++k) filter.update(bias, up, 0.01), worst = std::max(worst, tilt());
  EXPECT_GT(worst, 0.01) << "before the biases are known";
  EXPECT_NEAR(tilt(), 0.0, 1e-6) << "after a minute";
  EXPECT_NEAR(2.0 * std::atan2(filter.q_WS().z, filter.q_WS().w), 0.5 + 60 * 0.005, 1e-3) << "nothing corrects it";
  filter.align(0.0, up);
  filter.update({}, {0.0, 0.0, 1.2 * kG}, 1.0), filter.update({}, {0.6 * kG, 0.0, kG}, 1.0);
  EXPECT_EQ(tilt(), 0.0) << "forces of an accelerating body correct nothing";
}

/// At rest the filter finds the tilt. Imus without the setting, beside one with it, have no orientation.
TEST(Imu, OrientationAtRestAndWhereItIsNotMeasured) {
  Drive d("position( pose [0 0 0 90] imu( rate 10 pose6 [0 0 0 0 30 0] orientation 1 ) imu( rate 10 ) )");
  for (int k = 0; k < 3; ++k) d.drive({});
  const base::Quaternion q = base::quaternion_of(M_PI / 2, {0.0, M_PI / 6});
  for (std::size_t k = 0; k + 1 < d.readings.size(); k += 2) {
    const auto& v = d.readings[k];
    for (const auto& [found, expected] : {std::pair{v[7], q.w}, {v[8], q.x}, {v[9], q.y}, {v[10], q.z}})
      EXPECT_NEAR(found, expected, 1e-12);
    EXPECT_TRUE(std::isnan(d.readings[k + 1][7]));
  }
  const base::Quaternion there = base::quaternion_of(0.0, {0.0, M_PI / 6 + 0.3});
  EXPECT_NEAR(d.farm.sense(0, kImu, 0, {5, 5, 0, 0}, {0.0, 0.3}).values[9], there.y, 1e-12) << "placed elsewhere";
  const std::vector<double> before = d.readings[d.readings.size() - 2];
  d.drive({});
  EXPECT_EQ(d.readings[d.readings.size() - 2], before) << "which changes nothing";
}

TEST(Imu, PresetsAreOfDataSheetsAndMayBeChanged) {
  const auto settings = [](const std::string& text) {
    const world::World world = world_of("position( imu( " + text + " ) )");
    return sensors::SensorSet(world).settings_of<sensors::Imu>(kImu)[0];
  };
  const sensors::Imu adis = settings("preset \"ADIS16470\"");
  EXPECT_NEAR(adis.gyro.noise * 180.0 / M_PI * 60.0, 0.34, 1e-12) << "[deg/sqrt(h)]";
  EXPECT_NEAR(adis.gyro.noise * 180.0 / M_PI * std::sqrt(2.0), 0.008, 1e-4) << "the stated density of one side";
  EXPECT_EQ(settings("preset \"ADIS16470\" gyro_noise 0").gyro.noise, 0.0);
  EXPECT_EQ(settings("preset \"ADIS16470\" gyro_noise 0").accel.noise, adis.accel.noise);
  EXPECT_GT(settings("preset \"MPU-6050\"").gyro.noise, settings("preset \"STIM300\"").gyro.noise);
}

TEST(Imu, ImpossibleSettingsAreRefused) {
  const auto refused = [](const std::string& text) {
    return refusal_of([&] { sensors::SensorSet(world_of("position(\nimu( " + text + " ) )")); });
  };
  expect_in("trial.world:2: there is no preset \"MPU6050\"; expected MPU-6050, ADIS16470, STIM300",
            refused("preset \"MPU6050\""));
  expect_in("the rate is 0.5 Hz; expected at least 1", refused("rate 0.5"));
  expect_in("'gyro_noise'", refused("gyro_noise -1"));
  expect_in("'accel_range'", refused("accel_range 0"));
  expect_in("expected 'orientation 1' with 'gains'", refused("gains [1 0.3]"));
  expect_in("two numbers from 0 to 1000", refused("orientation 1 gains [-1 0]"));
  expect_in("'pose6'", refused("pose6 [1 2 3]"));
}

}  // namespace
}  // namespace sf::trial
