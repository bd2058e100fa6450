#include "robots/estimation/localization.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "robots/estimation/chi_square.h"
#include "tests/instrumented.h"
#include "tests/robots/estimation/driven_robot.h"
#include "tests/robots/estimation/reference.h"

namespace sf::estimation {
namespace {

using reference::DrivenRobot;

const int kSeeds = instrumented() ? 10 : 100;
/// In each tail: one in forty of all runs, and of the few instrumented seeds only a gross fault.
const double kTail = instrumented() ? 1e-4 : 0.025;

const LocalizationOptions kOwnWheels{.encoder = LocalizationOptions::Encoder{}};
/// For wheels whose constants are known.
const LocalizationOptions kKnownWheels{
    .encoder = LocalizationOptions::Encoder{.scale_sigma = 0.0, .difference_sigma = 0.0, .track_sigma = 0.0}};

Localization started(const LocalizationOptions& options, const base::Pose& X_WM = {}) {
  Localization localization(options);
  localization.add_pose(0, X_WM, kKnownStart);
  return localization;
}

std::uint64_t count(const Localization& localization, Verdict verdict) {
  return localization.counts()[static_cast<std::size_t>(verdict)];
}

/// Drives curves and straight lines at 0.1 m/s for a number of ticks.
void drive(DrivenRobot& robot, Localization& localization, int ticks, bool cameras, bool gyro = false) {
  for (int k = 0; k < ticks; ++k) {
    const double turn = std::array{0.0, 0.3, 0.0, -0.3}[robot.time / (5 * kSecond) % 4];
    robot.drive({0.1, 0.0, turn}, kTick);
    robot.add_encoder(localization);
    if (gyro) robot.add_gyro(localization);
    if (cameras) robot.add_camera(localization);
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Calibration, and loss of the cameras

/// Normalised squared error of the pose.
double pose_nees(const Prediction& prediction, const base::Pose& truth) {
  const auto& [time, X, v, P] = prediction.estimate;
  reference::Matrix few{};
  for (int i = 0; i < 6; ++i) few[i][i] = 1.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) few[i][j] = P[6 * i + j];
  const reference::Matrix information = reference::inverse(few);
  const std::array<double, 3> e{X.x - truth.x, X.y - truth.y, base::wrap_angle(X.yaw - truth.yaw)};
  double sum = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += e[i] * information[i][j] * e[j];
  return sum;
}

TEST(Localization, LearnsTheScaleAndCoastsThroughLossesOfTheCameras) {
  constexpr double kSlip = 0.001;  // 0.005 alone would allow an error of 45 mm
  std::vector<double> nees(3, 0.0);
  for (int seed = 1; seed <= kSeeds; ++seed) {
    DrivenRobot robot{.left_scale = 1.05, .right_scale = 1.05, .slip = kSlip, .random = std::mt19937_64(seed)};
    Localization localization({.encoder = LocalizationOptions::Encoder{.slip = kSlip}});
    drive(robot, localization, 600, true);
    const Calibration calibration = localization.calibration();
    EXPECT_NEAR(calibration.left_scale.value, 1.05, 0.01) << seed;
    EXPECT_NEAR(calibration.right_scale.value, 1.05, 0.01) << seed;
    EXPECT_LT(calibration.left_scale.sigma, 0.005);
    nees[0] += pose_nees(localization.predict(robot.time), robot.X_WM);
    drive(robot, localization, 100, false);
    nees[1] += pose_nees(localization.predict(robot.time), robot.X_WM);
    drive(robot, localization, 100, false);
    nees[2] += pose_nees(localization.predict(robot.time), robot.X_WM);
    EXPECT_LT(robot.error(localization), 0.04) << seed;
  }
  for (const double sum : nees) {
    EXPECT_GT(sum, chi_square_limit(3 * kSeeds, 1.0 - kTail)) << "the covariance is too large";
    EXPECT_LT(sum, chi_square_limit(3 * kSeeds, kTail)) << "the covariance is too small";
  }
}

/// A floor on which wheels slip by 5 % is learned like scales, and the covariance holds: cameras see the robot on it
/// for 40 s, then fail for 20 s. Before the slip was noticed, NEES was 199 per dimension.
TEST(Localization, LearnsASlipThatLasts) {
  const int seeds = instrumented() ? 5 : 50;
  for (const auto& [left, right] : {std::pair{1.05, 1.05}, {1.05, 1.0}, {0.95, 0.97}}) {
    double seen = 0.0, lost = 0.0;
    for (int seed = 1; seed <= seeds; ++seed) {
      DrivenRobot robot{.slip = 0.001, .random = std::mt19937_64(seed)};
      Localization localization({.encoder = LocalizationOptions::Encoder{.slip = 0.001}});
      drive(robot, localization, 600, true);
      robot.left_scale = left, robot.right_scale = right;
      drive(robot, localization, 400, true);
      const Calibration calibration = localization.calibration();
      EXPECT_NEAR(calibration.left_scale.value, left, 0.02) << seed;
      EXPECT_NEAR(calibration.right_scale.value, right, 0.02) << seed;
      seen += pose_nees(localization.predict(robot.time), robot.X_WM) / (3 * seeds);
      drive(robot, localization, 200, false);
      lost += pose_nees(localization.predict(robot.time), robot.X_WM) / (3 * seeds);
      EXPECT_LT(robot.error(localization), 0.05) << seed;
    }
    EXPECT_LT(seen, 2.0) << left << " and " << right;
    EXPECT_LT(lost, 2.0) << left << " and " << right;
  }
}

/// A car in bends, with satellites. Its origin moves sideways, as that of a single-track model, and the
/// scales of its wheels drift. Filters that know of one or none of these are overconfident.
TEST(Localization, CoversTheSlipOfACar) {
  using Tyres = LocalizationOptions::Tyres;
  constexpr double kSpeed = 14.0, kLever = 1.2 - 0.0047 * kSpeed * kSpeed;
  const std::array<std::optional<Tyres>, 4> kKnown{Tyres{1.2, 0.0047}, Tyres{1.2, 0.0047, 1e-6}, Tyres{1.2, 0.0}, {}};
  std::array<double, 4> nees{};
  for (int seed = 1; seed <= kSeeds; ++seed) {
    DrivenRobot car{.track = 1.4, .slip = 5e-4, .random = std::mt19937_64(seed)};
    std::vector<Localization> filters;
    for (const auto& tyres : kKnown)
      filters.push_back(started({.encoder = LocalizationOptions::Encoder{.slip = 5e-4, .track = 1.4},
                                 .tyres = tyres,
                                 .gyro = {.bias = 1e-4},
                                 .gps_noise = 1.0}));
    for (int k = 0; k < 400; ++k) {
      const double turn = 0.18 * std::sin(0.02 * k), drift = car.normal(3e-3 * std::sqrt(0.1));
      car.left_scale += drift, car.right_scale += drift;
      car.drive({kSpeed, kLever * turn, turn}, kTick);
      const double rate = turn + car.normal(1.7e-3), x = car.X_WM.x + car.normal(1.0), y = car.X_WM.y + car.normal(1.0);
      for (Localization& filter : filters) {
        car.add_encoder(filter), filter.add_gyro(car.time, rate);
        if (k % 2 == 0) filter.add_gps(car.time, x, y, std::sqrt(2.0));
      }
    }
    for (std::size_t f = 0; f < filters.size(); ++f)
      nees[f] += pose_nees(filters[f].predict(car.time), car.X_WM) / (3.0 * kSeeds);
  }
  EXPECT_GT(nees[0], instrumented() ? 0.3 : 0.7);
  EXPECT_LT(nees[0], instrumented() ? 2.0 : 1.3);
  for (std::size_t f = 1; f < nees.size(); ++f) EXPECT_GT(nees[f], 1.5 * nees[0]) << f;
}

TEST(Localization, SeparatesTheTrackFromTheScales) {
  DrivenRobot robot{.left_scale = 1.03, .right_scale = 1.01, .track = 0.258 * 1.04};
  Localization localization(kOwnWheels);
  drive(robot, localization, 2000, true);
  const auto [left, right, track, bias, scale] = localization.calibration();
  EXPECT_NEAR(left.value, 1.03, 3.0 * left.sigma + 1e-3);
  EXPECT_NEAR(right.value, 1.01, 3.0 * right.sigma + 1e-3);
  EXPECT_NEAR(track.value, 0.258 * 1.04, 3.0 * track.sigma + 1e-3);
  EXPECT_LT(track.sigma, 0.003);
}

TEST(Localization, LearnsTheBiasOfAGyro) {
  DrivenRobot robot{.gyro_bias = 0.01};
  Localization localization = started(kKnownWheels);
  drive(robot, localization, 600, false, true);
  EXPECT_NEAR(localization.calibration().gyro_bias.value, 0.01, 1e-3);
}

/// Two minutes of curves to the left by wheels and a gyro with unknown constants, without cameras. Filters that take
/// the gyro's scale for exact state a variance of yaw that is several times too small.
TEST(Localization, CoversTheScaleErrorOfAGyro) {
  const int seeds = instrumented() ? 20 : kSeeds;
  double sum = 0.0, without = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    DrivenRobot robot{.random = std::mt19937_64(seed)};
    const double common = robot.normal(0.01), half = 0.5 * robot.normal(0.01);
    robot.left_scale = 1.0 + common - half, robot.right_scale = 1.0 + common + half;
    robot.track *= 1.0 + robot.normal(0.05);
    robot.gyro_bias = robot.normal(1e-4), robot.gyro_scale = 1.0 + robot.normal(0.01);
    LocalizationOptions options{.encoder = LocalizationOptions::Encoder{.scale_sigma = 0.01},
                                .gyro = {.bias = 1e-4, .scale = 0.01}};
    Localization covers(options);
    options.gyro.scale = 0.0;
    Localization ignores(options);
    for (Localization* filter : {&covers, &ignores}) filter->add_pose(0, robot.X_WM, {1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6});
    for (int k = 0; k < 1200; ++k) {
      robot.drive({0.1, 0.0, k / 50 % 2 == 0 ? 0.0 : 0.3}, kTick);
      const double rate = robot.gyro_scale * robot.velocity.turn + robot.gyro_bias + robot.normal(1.7e-3);
      for (Localization* filter : {&covers, &ignores}) robot.add_encoder(*filter), filter->add_gyro(robot.time, rate);
    }
    sum += pose_nees(covers.predict(robot.time), robot.X_WM) / (3 * seeds);
    without += pose_nees(ignores.predict(robot.time), robot.X_WM) / (3 * seeds);
  }
  // Twenty instrumented seeds show only a gross fault: beyond the quantiles of 1.5e-4 for 60 degrees of freedom.
  EXPECT_GT(sum, instrumented() ? 0.47 : 0.7);
  EXPECT_LT(sum, instrumented() ? 1.8 : 1.3);
  EXPECT_GT(without, 2.0) << "the trial shows the error";
}

TEST(Localization, LearnsTheScaleOfAGyro) {
  DrivenRobot robot{.gyro_scale = 1.03};
  Localization localization({.encoder = LocalizationOptions::Encoder{}, .gyro = {.scale = 0.05}});
  drive(robot, localization, 1200, true, true);
  EXPECT_NEAR(localization.calibration().gyro_scale.value, 1.03, 3.0 * localization.calibration().gyro_scale.sigma);
  EXPECT_LT(localization.calibration().gyro_scale.sigma, 0.005);
}

/// Commands change the turn rate between two encoder readings, whose mean then differs from the gyro's reading.
TEST(Localization, TurnsThatBeginBetweenReadingsKeepTheCovariance) {
  constexpr double kDegree = M_PI / 180.0, kSpeed = 0.2, kTurnRate = 0.4;
  constexpr std::int64_t kHalfTick = kTick / 2;
  const LocalizationOptions options{.encoder = LocalizationOptions::Encoder{},
                                    .gyro = {.noise = 0.1 * kDegree, .bias = 0.5 * kDegree, .scale = 0.01}};
  double sum = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    DrivenRobot robot;
    robot.random.seed(static_cast<std::uint64_t>(seed));
    robot.gyro_bias = robot.normal(options.gyro.bias), robot.gyro_scale = 1.0 + robot.normal(options.gyro.scale);
    Localization localization = started(options, {robot.normal(0.05), robot.normal(0.05), 0.0, robot.normal(0.02)});
    int phase = 0, left = 1;  // half ticks until the next phase: straight, turn, straight, rest
    base::Twist twist;
    for (int k = 0; k < 2 * 1400; ++k) {
      if (--left == 0) {
        phase = (phase + 1) % 4;
        twist = {phase == 3 ? 0.0 : kSpeed, 0.0, phase == 1 ? std::copysign(kTurnRate, robot.normal(1.0)) : 0.0};
        left = phase == 1 ? 79 : phase == 3 ? 40 : 60 + static_cast<int>(40.0 * std::abs(robot.normal(1.0)));
      }
      robot.drive(twist, kHalfTick);
      if (k % 2 == 0) continue;
      robot.add_encoder(localization);
      robot.add_gyro(localization);
    }
    const Estimate estimate = localization.predict(robot.time).estimate;
    const double error = base::wrap_angle(estimate.X_WM.yaw - robot.X_WM.yaw);
    sum += error * error / estimate.covariance[kYaw * (kComponents + 1)];
  }
  // Three standard deviations of the mean of chi-square variables; 2.5 if both rates are taken as one.
  EXPECT_LT(sum / kSeeds, 1.0 + 3.0 * std::sqrt(2.0 / kSeeds));
  EXPECT_GT(sum / kSeeds, 1.0 - (instrumented() ? 1.0 : 3.0) * std::sqrt(2.0 / kSeeds));
}

/// Three landmarks around, seen as points with an error along and across the ray.
TEST(Localization, SightingsOfLandmarksMatchTheirCovariance) {
  constexpr std::array<glm::dvec2, 3> kLandmarks{{{3.0, 1.0}, {-1.0, 4.0}, {-2.0, -3.0}}};
  double sum = 0.0, sigma = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    DrivenRobot robot{.random = std::mt19937_64(seed)};
    Localization localization(kOwnWheels);
    localization.add_pose(0, {robot.normal(0.05), robot.normal(0.05), 0.0, robot.normal(0.02)}, kKnownStart);
    for (int k = 0; k < 600; ++k) {
      drive(robot, localization, 1, false);
      for (const glm::dvec2& p : kLandmarks) {
        const glm::dvec2 d = base::rotate(-robot.X_WM.yaw, p - glm::dvec2{robot.X_WM.x, robot.X_WM.y});
        const double range = glm::length(d), across = 0.02 * range;
        const glm::dvec2 u = d / range,
                         seen = d + robot.normal(0.05) * u + robot.normal(across) * glm::dvec2{-u.y, u.x};
        const double a = 2.5e-3, b = across * across;
        if (k % 5 == 0)
          localization.add_sighting(
              robot.time, p, seen, {a * u.x * u.x + b * u.y * u.y, (a - b) * u.x * u.y, a * u.y * u.y + b * u.x * u.x});
      }
    }
    const Prediction prediction = localization.predict(robot.time);
    sum += pose_nees(prediction, robot.X_WM);
    sigma = std::max(sigma, std::sqrt(prediction.estimate.covariance[0]));
  }
  EXPECT_GT(sum, chi_square_limit(3 * kSeeds, 1.0 - kTail));
  EXPECT_LT(sum, chi_square_limit(3 * kSeeds, kTail));
  EXPECT_LT(sigma, 0.03) << "[m]";
}

TEST(Localization, KnownWheelsMatchTheirCovariance) {
  // Without cameras, one minute: only slips, skids and rounding.
  double sum = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    DrivenRobot robot{.random = std::mt19937_64(seed)};
    Localization localization(kKnownWheels);
    localization.add_pose(0, robot.X_WM, {1e-8, 0.0, 0.0, 1e-8, 0.0, 1e-8});
    robot.add_encoder(localization);
    drive(robot, localization, 600, false);
    sum += pose_nees(localization.predict(robot.time), robot.X_WM);
  }
  EXPECT_GT(sum, chi_square_limit(3 * kSeeds, 1.0 - kTail));
  EXPECT_LT(sum, chi_square_limit(3 * kSeeds, kTail));
}

TEST(Localization, RestKeepsThePose) {
  // An hour at rest: neither the encoders' rounding nor time moves the estimate.
  DrivenRobot robot;
  Localization localization = started(kKnownWheels);
  robot.add_encoder(localization);
  for (int k = 0; k < (instrumented() ? 3'600 : 36'000); ++k) {
    robot.drive({}, kTick);
    robot.add_encoder(localization);
  }
  const Estimate now = localization.predict(robot.time).estimate;
  EXPECT_LT(robot.error(localization), 1e-3);
  EXPECT_LT(std::sqrt(now.covariance[0]), 0.06) << "the start's 0.05 m and a little rounding";
}

TEST(Localization, TurnsBetweenTwoCountsAreNotBias) {
  // 0.02 rad/s in place: one count of each wheel in four readings.
  Localization localization = started(kKnownWheels);
  for (int k = 0; k <= 600; ++k) {
    const double rolled = 1e-3 * std::round(0.02 * 0.1 * k * 0.258 / 2.0 / 1e-3);
    localization.add_encoder(k * kTick, -rolled, rolled);
    localization.add_gyro(k * kTick, 0.02);
  }
  EXPECT_NEAR(localization.predict(600 * kTick).estimate.X_WM.yaw, 1.2, 0.05);
}

TEST(Localization, TheGyroAloneCarriesTheHeadingWithoutEncoders) {
  Localization localization = started(kOwnWheels);
  for (int k = 0; k <= 10; ++k) localization.add_encoder(k * kTick, 0.0, 0.0), localization.add_gyro(k * kTick, 0.0);
  for (int k = 31; k <= 60; ++k) localization.add_gyro(k * kTick, 1.0);
  EXPECT_NEAR(localization.predict(60 * kTick).estimate.velocity.turn, 1.0, 0.01);
}

// ---------------------------------------------------------------------------------------------------------------------
// Late, wrong and missing measurements

TEST(Localization, NonFiniteReadingsChangeNothing) {
  Localization localization = started(kOwnWheels, {1.0, 2.0, 0.0, 0.5});
  localization.add_encoder(kTick, 0.0, 0.0);
  const Prediction before = localization.predict(kTick);
  localization.add_encoder(kTick, kNaN, 0.0);
  localization.add_encoder(kTick, std::numeric_limits<double>::max(), -std::numeric_limits<double>::max());
  localization.add_gyro(kTick, std::numeric_limits<double>::infinity());
  localization.add_gps(kTick, kNaN, kNaN, kNaN);
  localization.add_gps(kTick, 1.0, 2.0, kNaN);
  localization.add_pose(kTick, {0.0, 0.0, kNaN, 0.0}, kKnownStart);
  localization.add_pose(kTick, {}, {1.0, 2.0, 0.0, 1.0, 0.0, 1.0});  // not positive definite
  localization.add_pose(-1, {}, kKnownStart);
  EXPECT_EQ(localization.predict(kTick).estimate.covariance, before.estimate.covariance);
  EXPECT_EQ(count(localization, Verdict::invalid), 8u);
}

TEST(Localization, SpikesOfTheGyroAreOutliers) {
  Localization localization = started(kOwnWheels);
  for (int k = 0; k < 10; ++k) localization.add_encoder(k * kTick, 0.0, 0.0), localization.add_gyro(k * kTick, 0.0);
  EXPECT_EQ(localization.add_gyro(10 * kTick, 1e6), Verdict::outlier);
}

TEST(Localization, OrderOfArrivalDoesNotMatter) {
  DrivenRobot robot{.left_scale = 1.02};
  Localization in_order(kOwnWheels), late(kOwnWheels);
  std::vector<std::pair<std::int64_t, base::Pose>> seen;
  for (int k = 0; k < 200; ++k) {
    robot.drive({0.2, 0.0, 0.2}, kTick);
    for (Localization* each : {&in_order, &late}) robot.add_encoder(*each);
    seen.emplace_back(robot.time, robot.seen());
    in_order.add_pose(robot.time, seen.back().second, robot.camera_covariance());
    // Half a second late, and every second pair swapped.
    const std::size_t place = seen.size() - 6 + (seen.size() % 2 == 0 ? 1 : static_cast<std::size_t>(-1));
    if (seen.size() > 7) late.add_pose(seen[place].first, seen[place].second, robot.camera_covariance());
  }
  EXPECT_EQ(count(late, Verdict::too_late), 0u);
  const auto a = in_order.calibration(), b = late.calibration();
  EXPECT_NEAR(a.left_scale.value, b.left_scale.value, 2.0 * a.left_scale.sigma);
  EXPECT_LT(robot.error(late), 0.02);
}

TEST(Localization, LatePositionsApplyAtTheirOwnTime) {
  // 0.2 m/s; the fix of half a second ago is 1 m to the left of the start.
  LocalizationOptions options = kKnownWheels;
  options.gps_noise = 1e-3;
  Localization on_time(options), late(options);
  for (Localization* each : {&on_time, &late}) each->add_pose(0, {}, {1.0, 0.0, 0.0, 1.0, 0.0, 4e-4});
  for (int k = 0; k <= 20; ++k) {
    for (Localization* each : {&on_time, &late}) each->add_encoder(k * kTick, 0.02 * k, 0.02 * k);
    if (k == 15) on_time.add_gps(k * kTick, 0.3, 1.0, 1.0);
  }
  late.add_gps(15 * kTick, 0.3, 1.0, 1.0);
  const base::Pose a = on_time.predict(20 * kTick).estimate.X_WM, b = late.predict(20 * kTick).estimate.X_WM;
  EXPECT_NEAR(a.x, 0.4, 0.01);
  EXPECT_NEAR(a.y, 1.0, 0.01);
  EXPECT_NEAR(a.x, b.x, 1e-9);
  EXPECT_NEAR(a.y, b.y, 1e-9);
}

TEST(Localization, PositionsMayBeASecondLateAtHighRates) {
  Localization localization = started(kOwnWheels);
  for (int k = 0; k <= 500; ++k) {
    localization.add_encoder(k * 4 * kMs, 0.0, 0.0);
    localization.add_gyro(k * 4 * kMs, 0.0);
  }
  localization.add_gps(kSecond, 0.0, 0.0, 1.0);
  EXPECT_EQ(count(localization, Verdict::too_late), 0u);
}

TEST(Localization, LostAndResetEncodersLoseNoPose) {
  DrivenRobot robot;
  Localization localization = started(kKnownWheels);
  for (int k = 0; k < 100; ++k) {
    robot.drive({0.2, 0.0, 0.1}, kTick);
    if (k < 40 || k > 60) robot.add_encoder(localization);  // two seconds are missing: distances are absolute
  }
  EXPECT_LT(robot.error(localization), 0.1);
  const base::Pose before = localization.predict(robot.time).estimate.X_WM;
  EXPECT_EQ(localization.add_encoder(robot.time + kTick, 1000.0, 1000.0), Verdict::outlier) << "a jump of a kilometre";
  EXPECT_EQ(localization.add_encoder(robot.time + 2 * kTick, 1000.0, 1000.0), Verdict::used);
  const base::Pose after = localization.predict(robot.time + 2 * kTick).estimate.X_WM;
  EXPECT_LT(std::hypot(after.x - before.x, after.y - before.y), 0.1);
}

TEST(Localization, OutlyingPosesAreRejected) {
  DrivenRobot robot;
  Localization localization(kOwnWheels);
  drive(robot, localization, 100, true);
  for (int k = 0; k < 5; ++k) {
    drive(robot, localization, 1, true);
    EXPECT_EQ(localization.add_pose(robot.time, {3.0, 3.0}, robot.camera_covariance()), Verdict::outlier);
  }
  EXPECT_LT(robot.error(localization), 0.02);
}

TEST(Localization, ARelocatedRobotKeepsItsConstants) {
  DrivenRobot robot{.left_scale = 1.05, .right_scale = 1.05};
  Localization localization(kOwnWheels);
  drive(robot, localization, 600, true);
  robot.X_WM.x += 4.0;
  robot.X_WM.yaw += 2.0;
  drive(robot, localization, 20, true);
  EXPECT_LT(robot.error(localization), 0.03) << "within two seconds";
  EXPECT_EQ(count(localization, Verdict::started), 2u);
  EXPECT_NEAR(localization.calibration().left_scale.value, 1.05, 0.01);
}

TEST(Localization, ARelocationBetweenTwoEncoderReadingsLosesNoMotion) {
  // At 0.2 m/s along x, with readings of the encoders at whole seconds and poses half a second later.
  Localization localization = started(kKnownWheels);
  double moved = 0.0;  // [m] by hand, along y
  for (int k = 0; k < 12; ++k) {
    if (k == 4) moved = 4.0;
    localization.add_encoder(k * kSecond, 0.2 * k, 0.2 * k);
    EXPECT_NEAR(localization.predict(k * kSecond).estimate.X_WM.x, 0.2 * k, 0.02) << k;
    localization.add_pose(k * kSecond + kSecond / 2, {0.2 * (k + 0.5), moved, 0.0, 0.0},
                          {1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6});
  }
  EXPECT_EQ(count(localization, Verdict::started), 2u);
  EXPECT_NEAR(localization.predict(12 * kSecond).estimate.X_WM.y, 4.0, 0.02);
}

// ---------------------------------------------------------------------------------------------------------------------
// Unknown starts, and robots without encoders

TEST(Localization, HasNoEstimateBeforeTheFirstPose) {
  Localization localization(kOwnWheels);
  EXPECT_EQ(localization.add_encoder(kTick, 0.1, 0.1), Verdict::no_track);
  EXPECT_EQ(localization.predict(kTick).status, Prediction::Status::none);
  EXPECT_EQ(localization.calibration().left_scale.value, 1.0);
  EXPECT_NEAR(localization.calibration().left_scale.sigma, std::hypot(0.05, 0.005), 1e-12);
}

TEST(Localization, AStartBetweenTwoEncoderReadingsLosesNoMotion) {
  Localization localization(kKnownWheels);
  localization.add_encoder(0, 5.0, 5.0);
  localization.add_pose(kTick / 2, {1.0, 2.0, 0.0, 0.0}, {1e-8, 0.0, 0.0, 1e-8, 0.0, 1e-8});
  localization.add_encoder(kTick, 5.02, 5.02);
  const Estimate now = localization.predict(kTick).estimate;
  EXPECT_NEAR(now.X_WM.x, 1.01, 1e-4);
  EXPECT_LT(std::sqrt(now.covariance[14]), 0.01) << "the heading is as known as before";
}

TEST(Localization, SatellitesAndWheelsShowTheHeading) {
  for (const double yaw : {0.0, 0.087, 1.0, -2.5, 3.14}) {
    DrivenRobot robot{.X_WM = {10.0, -5.0, 0.0, yaw}};
    LocalizationOptions options = kOwnWheels;
    options.gps_noise = 0.5;
    Localization localization(options);
    for (int k = 0; k < 300; ++k) {
      robot.drive({0.5, 0.0, 0.0}, kTick);
      robot.add_encoder(localization);
      localization.add_gps(robot.time, robot.X_WM.x + robot.normal(0.35), robot.X_WM.y + robot.normal(0.35), 1.0);
      if (k == 1) {
        EXPECT_GT(localization.predict(robot.time).estimate.covariance[14], 2.0) << "all headings";
      }
    }
    const Estimate now = localization.predict(robot.time).estimate;
    EXPECT_LT(std::abs(base::wrap_angle(now.X_WM.yaw - yaw)), 4.0 * std::sqrt(now.covariance[14])) << yaw;
    EXPECT_LT(std::sqrt(now.covariance[14]), 0.05);
    EXPECT_LT(robot.error(localization), 0.4);
  }
}

TEST(Localization, CamerasAloneGiveThePoseAndTheVelocity) {
  DrivenRobot robot;
  Localization localization({});
  for (int k = 0; k < 100; ++k) {
    robot.drive({0.2, 0.0, 0.1}, kTick);
    robot.add_camera(localization);
  }
  const Estimate now = localization.predict(robot.time).estimate;
  EXPECT_LT(robot.error(localization), 0.015);
  EXPECT_NEAR(now.velocity.forward, 0.2, 0.06);
  EXPECT_EQ(localization.add_encoder(robot.time, 1.0, 1.0), Verdict::invalid) << "it has no encoders";
}

TEST(Localization, OmniRobotsDriveSideways) {
  DrivenRobot robot;
  Localization localization({.sideways = true});
  for (int k = 0; k < 100; ++k) {
    robot.drive({0.0, 0.3, 0.0}, kTick);
    robot.add_camera(localization);
  }
  EXPECT_NEAR(localization.predict(robot.time).estimate.velocity.left, 0.3, 0.06);
}

}  // namespace
}  // namespace sf::estimation
