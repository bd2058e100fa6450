// Odometry of encoders compared with true paths, and its covariance with the spread of its errors.

#include "record/odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace sf::record {
namespace {

constexpr std::int64_t kStep = 100'000'000;  // [ns]
constexpr EncoderInfo kWheels{8, 1e-3, 0.005, 0.258};

/// A robot on a path of arcs, and its encoders with slip and rounding.
struct Drive {
  explicit Drive(const EncoderInfo& encoder, unsigned seed = 1)
      : wheels(encoder), random(seed), odometer({.encoder = encoder}, OdometrySource::encoders) {}

  /// @param forward [m/s] @param turn [rad/s]
  void step(double forward, double turn) {
    const double seconds = 1e-9 * kStep, half = 0.5 * turn * seconds;
    const double chord = forward * seconds * (half == 0.0 ? 1.0 : std::sin(half) / half);
    const glm::dvec2 d = base::rotate(X_WM.yaw + half, {chord, 0.0});
    X_WM = {X_WM.x + d.x, X_WM.y + d.y, X_WM.z, X_WM.yaw + turn * seconds};
    const double ways[2] = {(forward - 0.5 * wheels.track * turn) * seconds,
                            (forward + 0.5 * wheels.track * turn) * seconds};
    for (int i = 0; i < 2; ++i) {
      std::normal_distribution<double> slip(0.0, 1.0);
      rolled[i] += ways[i] + wheels.slip * std::sqrt(std::abs(ways[i])) * slip(random);
      values[i] = wheels.per_count * std::floor(rolled[i] / wheels.per_count + 0.5);
    }
    time += kStep;
    read();
  }
  bool read() {
    base::ReadingBlock reading{.type = 8, .time = time, .X_WM = X_WM, .values = values};
    return odometer.roll(reading);
  }
  /// The path of all tests: arcs, a stop, a turn on the spot, backwards.
  void go() {
    for (int i = 0; i < 200; ++i) step(0.3, 0.5 * std::sin(0.1 * i));
    for (int i = 0; i < 10; ++i) step(0.0, 0.0);
    for (int i = 0; i < 20; ++i) step(0.0, 1.0);
    for (int i = 0; i < 100; ++i) step(-0.2, 0.1);
  }
  /// Returns the error in the odometry's frame, which began at X_WO.
  std::array<double, 3> error(const base::Pose& X_WO) const {
    const glm::dvec2 p = base::rotate(-X_WO.yaw, {X_WM.x - X_WO.x, X_WM.y - X_WO.y});
    const base::Pose& X_OM = odometer.state().X_OM;
    return {X_OM.x - p.x, X_OM.y - p.y, base::wrap_angle(X_OM.yaw - (X_WM.yaw - X_WO.yaw))};
  }

  EncoderInfo wheels;
  std::mt19937 random;
  Odometer odometer;
  base::Pose X_WM{2.0, -1.0, 0.3, 2.5};
  double rolled[2] = {}, values[2] = {};
  std::int64_t time = 0;
};

const base::Pose kStart{2.0, -1.0, 0.3, 2.5};

TEST(Odometry, FineEncodersFollowTheTruePath) {
  Drive drive({8, 1e-9, 0.0, 0.258});
  EXPECT_TRUE(drive.read()) << "the first reading, at 0";
  drive.go();
  for (const double error : drive.error(kStart)) EXPECT_NEAR(error, 0.0, 1e-6);
  const OdometryState& state = drive.odometer.state();
  EXPECT_NEAR(state.velocity.forward, -0.2, 1e-6);
  EXPECT_NEAR(state.velocity.turn, 0.1, 1e-6);
  // The frame is at the robot's start, at its height.
  EXPECT_NEAR(std::hypot(state.X_WO.x - kStart.x, state.X_WO.y - kStart.y), 0.0, 1e-6);
  EXPECT_NEAR(base::wrap_angle(state.X_WO.yaw - kStart.yaw), 0.0, 1e-6);
  EXPECT_EQ(state.X_WO.z, kStart.z);
  EXPECT_EQ(state.X_OM.z, 0.0);
}

/// Whatever the errors, both transforms together give the true pose.
TEST(Odometry, FrameCompensatesErrors) {
  Drive drive({8, 0.01, 0.1, 0.258});
  drive.go();
  const OdometryState& state = drive.odometer.state();
  const base::Pose X_WM = base::compose(state.X_WO, state.X_OM);
  EXPECT_GT(std::abs(drive.error(kStart)[0]), 1e-3);
  EXPECT_NEAR(X_WM.x, drive.X_WM.x, 1e-12);
  EXPECT_NEAR(X_WM.y, drive.X_WM.y, 1e-12);
  EXPECT_NEAR(base::wrap_angle(X_WM.yaw - drive.X_WM.yaw), 0.0, 1e-12);
}

/// Returns the squared error normalised by the stated covariance: 3 on average, the number of dimensions.
double normalised_square(const Drive& drive, const base::Pose& X_WO) {
  const auto [x, y, a] = drive.error(X_WO);
  const auto& [xx, xy, xa, yy, ya, aa] = drive.odometer.state().covariance.pose;
  // e' P^-1 e, computed with the adjugate.
  const double A = yy * aa - ya * ya, B = xa * ya - xy * aa, C = xy * ya - xa * yy;
  const double D = xx * aa - xa * xa, E = xa * xy - xx * ya, F = xx * yy - xy * xy;
  const double determinant = xx * A + xy * B + xa * C;
  EXPECT_GT(determinant, 0.0);
  return (A * x * x + D * y * y + F * a * a + 2 * (B * x * y + C * x * a + E * y * a)) / determinant;
}

/// @param runs number of runs with different seeds, each after a short distance that randomises the phase between two
/// counts
double mean_square(const EncoderInfo& wheels, int runs, const std::function<void(Drive&)>& go) {
  double sum = 0.0;
  for (int run = 0; run < runs; ++run) {
    Drive drive(wheels, static_cast<unsigned>(run));
    drive.X_WM.yaw += 0.01 * run;
    const base::Pose X_WO = drive.X_WM;
    std::uniform_real_distribution<double> some(-1.0, 1.0);
    for (int i = 0; i < 3; ++i) drive.step(0.3 * some(drive.random), some(drive.random));
    go(drive);
    sum += normalised_square(drive, X_WO);
  }
  return sum / runs;
}

void drive_on(Drive& drive, double forward, double turn, int steps) {
  for (int i = 0; i < steps; ++i) drive.step(forward, turn);
}

/// docs/bridges.md states these bands.
TEST(Odometry, ErrorsMatchTheStatedCovariance) {
  struct Case {
    const char* name;
    std::function<void(Drive&)> go;
  };
  const Case cases[] = {{"straight ahead, 30 counts a step", [](Drive& d) { drive_on(d, 0.3, 0.0, 260); }},
                        {"straight ahead, 33.33 counts", [](Drive& d) { drive_on(d, 0.3333, 0.0, 260); }},
                        {"straight back", [](Drive& d) { drive_on(d, -0.25, 0.0, 260); }},
                        {"wide curve", [](Drive& d) { drive_on(d, 0.2, 0.1, 260); }},
                        {"curve", [](Drive& d) { drive_on(d, 0.3, 0.5, 260); }},
                        {"curve back", [](Drive& d) { drive_on(d, -0.2, 0.1, 260); }},
                        {"circles", [](Drive& d) { drive_on(d, 0.25, 1.0, 260); }},
                        {"round a wheel", [](Drive& d) { drive_on(d, 0.129, 1.0, 260); }},
                        {"on the spot", [](Drive& d) { drive_on(d, 0.0, 1.0, 100); }},
                        {"a square",
                         [](Drive& d) {
                           for (int side = 0; side < 4; ++side)
                             drive_on(d, 0.3, 0.0, 60), drive_on(d, 0.0, M_PI / 2.0, 10);
                         }},
                        {"arcs, a stand, a turn on the spot, backwards", [](Drive& d) { d.go(); }},
                        {"with ever other speeds", [](Drive& d) {
                           for (int i = 0; i < 260; ++i)
                             d.step(0.2 + 0.1 * std::sin(0.13 * i), 0.8 * std::sin(0.07 * i + 1.0));
                         }}};
  for (const Case& c : cases)
    for (const double slip : {0.0, 0.005, 0.02, 0.05}) {
      const double mean = mean_square({8, 1e-3, slip, 0.258}, 400, c.go);
      EXPECT_LT(mean, slip > 0.0 ? 3.4 : 3.7) << c.name << ", slip " << slip;
      EXPECT_GT(mean, slip > 0.0 ? 2.1 : 1.0) << c.name << ", slip " << slip;
    }
  EXPECT_NEAR(mean_square({8, 1e-6, 0.003, 0.4}, 400, [](Drive& d) { d.go(); }), 3.0, 0.5) << "slip alone";
}

TEST(Odometry, CovarianceGrowsOnlyWithTheDistanceDriven) {
  Drive drive(kWheels);
  std::array<double, 6> last{};
  for (int i = 0; i < 100; ++i) {
    drive.step(0.3, 0.0);
    const auto& P = drive.odometer.state().covariance.pose;
    for (const std::size_t k : {0, 3, 5}) EXPECT_GT(P[k], last[k]) << k;
    last = P;
  }
  drive.step(0.0, 0.0);
  const auto& P = drive.odometer.state().covariance.pose;
  for (const std::size_t k : {0, 3, 5}) EXPECT_DOUBLE_EQ(P[k], last[k]) << "at rest";
  // 3 m straight ahead: each wheel's variance is slip^2 3 m, its last count 1 mm / sqrt(12).
  const double slip = 0.005 * 0.005 * 3.0, count = 1e-6 / 12.0;
  // A heading of variance h after a metre shortens L metres by half the integral of its square: 7/48 (h L^2)^2.
  const double heading = 2.0 * slip / (0.258 * 0.258);
  EXPECT_NEAR(P[0], 0.5 * (slip + count) + 7.0 / 48.0 * std::pow(heading * 3.0, 2), 0.02 * P[0]);
  EXPECT_NEAR(P[5], 2.0 * (slip + count) / (0.258 * 0.258), 0.02 * P[5]);
}

TEST(Odometry, VelocityCovarianceIncludesRounding) {
  Drive drive({8, 1e-3, 0.0, 0.258});
  drive.step(0.3, 0.0);
  const auto& twist = drive.odometer.state().covariance.twist;
  const double wheel = 1e-6 / 6.0 / 0.01;  // two rounded counts, 0.1 s apart
  EXPECT_NEAR(twist[0], 0.5 * wheel, 1e-8);
  EXPECT_NEAR(twist[1], 0.0, 1e-12);
  EXPECT_NEAR(twist[2], 2.0 * wheel / (0.258 * 0.258), 1e-7);
}

TEST(Odometry, IgnoresReadingsOutOfOrder) {
  Drive drive(kWheels);
  drive.step(0.3, 0.0);
  const double x = drive.odometer.state().X_OM.x;
  EXPECT_TRUE(drive.read()) << "shown again";
  EXPECT_EQ(drive.odometer.state().X_OM.x, x);
  EXPECT_GT(drive.odometer.state().velocity.forward, 0.2);
  drive.time -= kStep / 2;
  EXPECT_FALSE(drive.read()) << "earlier";
  EXPECT_EQ(drive.odometer.state().time, kStep);
}

TEST(Odometry, IgnoresReadingsOfOtherSensors) {
  const Odometer with({.encoder = kWheels}, OdometrySource::encoders), without({}, OdometrySource::encoders);
  EXPECT_TRUE(with.reads({.type = 8}));
  EXPECT_FALSE(with.reads({.type = 9}));
  EXPECT_FALSE(with.reads({.sensor = 1, .type = 8})) << "the second encoders";
  EXPECT_FALSE(without.reads({.type = 8}));
  EXPECT_FALSE(Odometer({.encoder = kWheels}, OdometrySource::exact).has_encoders());
}

TEST(Odometry, ExactOdometryBeginsAtTheStartPose) {
  Odometer odometer({}, OdometrySource::exact);
  odometer.move(0, kStart, {});
  EXPECT_NEAR(odometer.state().X_OM.x, 0.0, 1e-15);
  const base::Pose later = base::compose(kStart, {1.0, 0.5, 0.0, 0.25});
  odometer.move(kStep, later, {0.3, 0.0, 0.1});
  const OdometryState& state = odometer.state();
  EXPECT_NEAR(state.X_OM.x, 1.0, 1e-12);
  EXPECT_NEAR(state.X_OM.y, 0.5, 1e-12);
  EXPECT_NEAR(state.X_OM.yaw, 0.25, 1e-12);
  EXPECT_EQ(state.velocity.turn, 0.1);
  EXPECT_EQ(state.covariance.pose[0], kLeastVariance);
  odometer.begin();
  odometer.move(0, later, {});
  EXPECT_NEAR(odometer.state().X_OM.x, 0.0, 1e-15) << "a new run";
}

/// A robot that is placed elsewhere has not driven there: its odometry continues, its frame moves.
TEST(Odometry, PlacementMovesTheFrame) {
  Odometer odometer({.max_forward = 0.5}, OdometrySource::exact);
  odometer.move(0, {}, {});
  odometer.move(kStep, {0.59, 0.0, 0.0, 0.0}, {});
  EXPECT_NEAR(odometer.state().X_OM.x, 0.59, 1e-12) << "0.5 m + 2 x 0.5 m/s x 0.1 s are a way";
  odometer.move(2 * kStep, {9.0, 3.0, 0.0, 1.0}, {});
  EXPECT_NEAR(odometer.state().X_OM.x, 0.59, 1e-12);
  EXPECT_NEAR(odometer.state().X_OM.yaw, 0.0, 1e-12);
  const base::Pose X_WM = base::compose(odometer.state().X_WO, odometer.state().X_OM);
  EXPECT_NEAR(X_WM.x, 9.0, 1e-12);
  EXPECT_NEAR(X_WM.yaw, 1.0, 1e-12);
}

TEST(Odometry, TruthIsThePoseInTheWorld) {
  Odometer odometer({.max_forward = 0.5, .encoder = kWheels}, OdometrySource::truth);
  odometer.move(0, kStart, {});
  odometer.move(kStep, {9.0, 3.0, 0.0, 1.0}, {});
  EXPECT_EQ(odometer.state().X_OM.x, 9.0);
  EXPECT_EQ(odometer.state().X_WO.x, 0.0);
  EXPECT_EQ(odometer.state().covariance.pose, (std::array<double, 6>{}));
}

/// A service states the accuracy of a state along the axes of the world.
TEST(Odometry, EstimatesKeepTheirCovariance) {
  Odometer odometer({}, OdometrySource::exact);
  const base::StateQuality quality{.stated = true, .covariance = {4.0F, 0.0F, 0.5F, 1.0F, 0.0F, 0.25F}};
  odometer.move(0, {0.0, 0.0, 0.0, M_PI / 2}, {}, quality);
  const auto& P = odometer.state().covariance.pose;
  const std::array<double, 6> expected{1.0, 0.0, 0.0, 4.0, -0.5, 0.25};  // the frame's x is the world's y
  for (std::size_t i = 0; i < P.size(); ++i) EXPECT_NEAR(P[i], expected[i], 1e-12) << i;
}

}  // namespace
}  // namespace sf::record
