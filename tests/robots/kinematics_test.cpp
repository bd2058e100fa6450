#include "robots/kinematics.h"
#include "base/tilted_pose.h"
#include "tests/units.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sf::robots {
namespace {

using base::Pose;
using base::Twist;

void expect_pose(const Pose& actual, const Pose& expected, double tolerance = 1e-12) {
  EXPECT_NEAR(actual.x, expected.x, tolerance);
  EXPECT_NEAR(actual.y, expected.y, tolerance);
  EXPECT_NEAR(actual.z, expected.z, tolerance);
  EXPECT_NEAR(base::wrap_angle(actual.yaw - expected.yaw), 0.0, tolerance);
}

TEST(Advance, Straight) { expect_pose(advance({1, 2, 3, M_PI / 2}, {0.5, 0, 0}, 2.0), {1, 3, 3, M_PI / 2}); }

TEST(Advance, TurnInPlace) { expect_pose(advance({1, 2, 0, 0}, {0, 0, 1}, 0.5), {1, 2, 0, 0.5}); }

TEST(Advance, Sideways) { expect_pose(advance({0, 0, 0, 0}, {0, 0.5, 0}, 2.0), {0, 1, 0, 0}); }

TEST(Advance, QuarterCircle) {
  // Radius v/w = 2 m. The arc ends at (R sin, R (1 - cos)).
  expect_pose(advance({}, {1.0, 0, 0.5}, M_PI), {2, 2, 0, M_PI / 2});
}

TEST(Advance, FullCircleReturnsToTheStart) { expect_pose(advance({5, 6, 0, 1}, {1, 0.3, 2}, M_PI), {5, 6, 0, 1}); }

TEST(Advance, ManySmallStepsEqualOneLargeStep) {
  Pose X{0.3, -0.2, 0, 2};
  for (int i = 0; i < 1000; ++i) X = advance(X, {0.4, -0.1, 0.7}, 0.01);
  expect_pose(X, advance({0.3, -0.2, 0, 2}, {0.4, -0.1, 0.7}, 10.0), 1e-11);
}

/// An arc of 1 m radius. Each step rounds a pose three times by half a grain of 2 m.
TEST(Advance, StepsOfAMicrosecondAndOfTenSecondsStayOnTheArc) {
  const auto on_arc = [](double angle) { return Pose{std::sin(angle), 1.0 - std::cos(angle), 0.0, angle}; };
  Pose X;
  for (int i = 0; i < 1'000'000; ++i) X = advance(X, {0.3, 0, 0.3}, 1e-6);
  expect_pose(X, on_arc(0.3), 1e6 * 3 * 2.2e-16);
  expect_pose(advance({}, {0.3, 0, 0.3}, 10.0), on_arc(3.0), 1e-14);
}

TEST(Advance, TinyTurnsAgreeWithTheStraightLine) {
  // Near the threshold of the series.
  for (const double turn : {1e-9, 1.9e-4, 2.1e-4}) {
    const Pose X = advance({}, {1, 0, turn}, 1.0);
    EXPECT_NEAR(X.x, std::sin(turn) / turn, 1e-15) << turn;
    EXPECT_NEAR(X.y, 2.0 * std::pow(std::sin(turn / 2), 2) / turn, 1e-12) << turn;
  }
}

TEST(Advance, YawIsWrapped) { EXPECT_LE(std::abs(advance({0, 0, 0, 3}, {0, 0, 1}, 20.0).yaw), M_PI); }

// --- Between two ticks.

base::Report at(std::int64_t time, const Pose& X_WM, const Twist& velocity) { return {0, time, X_WM, velocity, 0}; }

/// A mover that is not stopped is on its arc at any part of the tick. Covers times before and at its own, within reach,
/// and beyond reach (half a second).
TEST(Extrapolate, FollowsTheTwistUpToItsReach) {
  const base::Report known{.mover = 3, .time = 100, .X_WM = {1.0, 0.0, 0.1, 4.0 * M_PI}, .velocity = {2.0, 0.0, 0.0}};
  for (const std::int64_t time : {0, 100}) {
    EXPECT_EQ(extrapolate(known, time).X_WM.x, 1.0);
    EXPECT_EQ(extrapolate(known, time).X_WM.yaw, 4.0 * M_PI) << "bitwise the same";
    EXPECT_EQ(extrapolate(known, time).time, 100);
  }
  EXPECT_NEAR(extrapolate(known, 100 + kMaxExtrapolation / 2).X_WM.x, 1.5, 1e-12);
  for (const std::int64_t beyond : {0, 1, 1'000'000'000}) {
    EXPECT_NEAR(extrapolate(known, 100 + kMaxExtrapolation + beyond).X_WM.x, 2.0, 1e-12);
    EXPECT_EQ(extrapolate(known, 100 + kMaxExtrapolation + beyond).time, 100 + kMaxExtrapolation);
  }
}

TEST(Interpolate, UnhinderedMoverStaysOnItsArc) {
  const Twist velocities[] = {{0.7, 0, 0}, {0.7, 0, 1.5}, {0.4, -0.3, -2}, {0, 0, 3}, {-0.2, 0, 1e-9}, {1.0, 0, 50.0}};
  for (const Twist& v : velocities) {
    const Pose start{3, -4, 0.25, 2.5};
    const base::Report before = at(5 * kTick, start, {}), after = at(6 * kTick, advance(start, v, 0.1), v);
    for (const std::int64_t part : {kTick / 13, kTick / 2, kTick - 1}) {
      const base::Report report = interpolate(before, after, 5 * kTick + part);
      expect_pose(report.X_WM, advance(start, v, 1e-9 * static_cast<double>(part)));
      EXPECT_EQ(report.time, 5 * kTick + part);
      EXPECT_EQ(report.velocity.turn, v.turn) << "its gyro's reading, also beyond half a turn in the tick";
    }
  }
}

/// Stopped or displaced: moves from one pose to the other by the smaller turn, at constant speed.
TEST(Interpolate, HinderedMoverIsOnTheArcBetweenItsPoses) {
  const base::Report before = at(0, {1, 2, 0, 3.0}, {0.5, 0, 0}), after = at(kTick, {0.98, 2.01, 0, -3.0}, {});
  expect_pose(interpolate(before, after, 0).X_WM, before.X_WM);
  expect_pose(interpolate(before, after, kTick - 1).X_WM, after.X_WM, 1e-8);
  const base::Report half = interpolate(before, after, kTick / 2);
  EXPECT_NEAR(std::abs(half.X_WM.yaw), M_PI, 1e-12) << "through straight behind";
  expect_pose(advance(half.X_WM, half.velocity, 0.05), after.X_WM);
  EXPECT_NEAR(half.velocity.turn, (2 * M_PI - 6.0) / 0.1, 1e-9);
}

/// Bitwise, for any reported velocity and any representation of the yaw.
TEST(Interpolate, MoverAtRestStaysAtRest) {
  const base::Report before = at(0, {0.1, 0.2, 0.3, 7.0}, {}), after = at(kTick, before.X_WM, {0.3, 0, 0});
  const base::Report report = interpolate(before, after, kTick / 3);
  EXPECT_EQ(report.X_WM.x, 0.1);
  EXPECT_EQ(report.X_WM.y, 0.2);
  EXPECT_EQ(report.X_WM.yaw, 7.0);
  EXPECT_EQ(report.X_WM.z, 0.3);
}

/// A lift, also without motion in the plane, and a ramp.
TEST(Interpolate, LevelMoverRisesEvenly) {
  for (const double x : {0.1, 0.2}) {
    const base::Report before = at(0, {0.1, 0.2, 0.3, 7.0}, {}), after = at(kTick, {x, 0.2, 0.5, 7.0}, {});
    EXPECT_NEAR(interpolate(before, after, kTick / 4).X_WM.z, 0.35, 1e-15);
    EXPECT_NEAR(velocity_between(before, after).linear.z, 2.0, 1e-12);
    EXPECT_EQ(interpolate(before, after, 0).X_WM.z, 0.3) << "bitwise the state before at its time";
  }
}

/// Height and tilt, too. The planar velocity is that of gyros and encoders.
TEST(Interpolate, TiltedMoverIsOnTheScrewMotionBetweenItsPoses) {
  base::Report before = at(0, {1, 2, 0.5, 3.0}, {}), after = at(kTick, {1.1, 2, 0.75, -3.0}, {});
  after.tilt = {0.1, -0.4};
  const base::TiltedPose expected = base::screw_between({before.X_WM, {}}, {after.X_WM, after.tilt}, 0.25);
  const base::Report report = interpolate(before, after, kTick / 4);
  expect_pose(report.X_WM, expected.X, 1e-15);
  EXPECT_NEAR(report.X_WM.z, expected.X.z, 1e-15);
  EXPECT_NEAR(report.tilt.roll, expected.tilt.roll, 1e-15);
  EXPECT_NEAR(report.tilt.pitch, expected.tilt.pitch, 1e-15);
  EXPECT_NEAR(report.velocity.turn, (2 * M_PI - 6.0) / 0.1, 1e-9);
  EXPECT_EQ(interpolate(before, after, 0).X_WM.z, 0.5) << "bitwise the state before at its time";
}

TEST(Interpolate, TiltedMoverAtRestStaysAtRest) {
  base::Report before = at(0, {0.1, 0.2, 0.3, 7.0}, {}), after = at(kTick, before.X_WM, {});
  before.tilt = after.tilt = {0.3, 0.2};
  const base::Report rest = interpolate(before, after, kTick / 3);
  EXPECT_EQ(rest.X_WM.yaw, 7.0) << "bitwise";
  EXPECT_EQ(rest.tilt.roll, 0.3);
  after.tilt.roll = 0.5;  // it tips over on the spot
  EXPECT_NEAR(interpolate(before, after, kTick / 2).tilt.roll, 0.4, 1e-15);
  after.tilt.roll = 0.3, after.X_WM.z = 0.5;  // it is lifted
  EXPECT_NEAR(interpolate(before, after, kTick / 2).X_WM.z, 0.4, 1e-15);
}

/// Contacts change at ticks only.
TEST(Interpolate, ContactIsThatOfTheTickBefore) {
  base::Report before = at(0, {}, {}), after = at(kTick, {0.01, 0, 0, 0}, {});
  before.contact_mask = 5;
  after.contact_mask = 6;
  EXPECT_EQ(interpolate(before, after, 1).contact_mask, 5u);
}

}  // namespace
}  // namespace sf::robots
