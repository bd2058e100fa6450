#include "robots/motion_limits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/units.h"

namespace sf::robots {
namespace {

using base::Twist;

world::Mover mover(world::Drive drive) {
  world::Mover m;
  m.drive = drive;
  m.max_forward = 0.5;
  m.max_turn = 1.0;
  m.wheelbase = 0.25;
  return m;
}

TEST(LimitKinematics, DifferentialAndSkidClampAndCannotSlide) {
  for (const auto drive : {world::Drive::differential, world::Drive::skid}) {
    const Twist v = limit_kinematics(mover(drive), {-3, 0.4, 7});
    EXPECT_EQ(v.forward, -0.5);
    EXPECT_EQ(v.left, 0.0);
    EXPECT_EQ(v.turn, 1.0);
  }
}

TEST(LimitKinematics, OmniKeepsItsDirection) {
  const Twist v = limit_kinematics(mover(world::Drive::omni), {3, -4, -0.5});
  EXPECT_NEAR(v.forward, 0.3, 1e-15);
  EXPECT_NEAR(v.left, -0.4, 1e-15);
  EXPECT_EQ(v.turn, -0.5);
}

TEST(LimitKinematics, CarTurnIsLimitedBySteering) {
  EXPECT_EQ(limit_kinematics(mover(world::Drive::car), {0, 0, 1}).turn, 0.0);
  EXPECT_NEAR(limit_kinematics(mover(world::Drive::car), {-0.1, 0, 1}).turn, 0.1 * std::tan(kMaxSteer) / 0.25, 1e-15);
}

world::Mover lazy(world::Drive drive) {
  world::Mover m = mover(drive);
  m.max_acceleration = 2.0;
  m.max_turn_acceleration = 4.0;
  return m;
}

TEST(LimitAcceleration, WithoutLimitsReturnsTheWantedTwist) {
  const Twist v = limit_acceleration(mover(world::Drive::differential), {0.1, 0, 0.3}, {0.37, 0, -0.9}, 0.1);
  EXPECT_EQ(v.forward, 0.37);
  EXPECT_EQ(v.turn, -0.9);
}

TEST(LimitAcceleration, LimitsSpeedingUpAndSlowingDown) {
  const world::Mover m = lazy(world::Drive::differential);
  EXPECT_DOUBLE_EQ(limit_acceleration(m, {}, {0.5, 0, 1.0}, 0.1).forward, 0.2);
  EXPECT_DOUBLE_EQ(limit_acceleration(m, {}, {0.5, 0, 1.0}, 0.1).turn, 0.4);
  EXPECT_DOUBLE_EQ(limit_acceleration(m, {0.5, 0, 1.0}, {}, 0.1).forward, 0.3);
  EXPECT_DOUBLE_EQ(limit_acceleration(m, {0.5, 0, 1.0}, {}, 0.1).turn, 0.6);
  EXPECT_DOUBLE_EQ(limit_acceleration(m, {0.1, 0, 0}, {-0.5, 0, 0}, 0.1).forward, -0.1) << "through zero";
  EXPECT_EQ(limit_acceleration(m, {0.5, 0, 0}, {0.31, 0, 0}, 0.1).forward, 0.31) << "within reach: exactly";
  EXPECT_EQ(limit_acceleration(m, {0, 0, 0.9}, {0, 0, 0.55}, 0.1).turn, 0.55);
}

TEST(LimitAcceleration, OmniChangesItsVelocityInOneDirection) {
  const Twist v = limit_acceleration(lazy(world::Drive::omni), {0.3, 0, 0}, {0, 0.4, 0}, 0.1);
  EXPECT_NEAR(v.forward, 0.3 - 0.2 * 0.6, 1e-15);
  EXPECT_NEAR(v.left, 0.2 * 0.8, 1e-15);
}

TEST(LimitAcceleration, CarAtRestDoesNotTurn) {
  const Twist v = limit_acceleration(lazy(world::Drive::car), {0.1, 0, 0.2}, {0, 0, 0}, 0.1);
  EXPECT_EQ(v.forward, 0.0);
  EXPECT_EQ(v.turn, 0.0) << "its steering allows no turn without speed";
}

TEST(LimitAcceleration, ReportsBeyondTheLimitsAreFollowedBackAtOnce) {
  EXPECT_EQ(limit_acceleration(lazy(world::Drive::differential), {5.0, 0.3, 0}, {0.5, 0, 0}, 0.1).forward, 0.5);
}

TEST(LimitKinematics, NonFiniteCommandsBecomeZero) {
  for (const auto drive : {world::Drive::differential, world::Drive::omni, world::Drive::car}) {
    const Twist v = limit_kinematics(mover(drive), {kNaN, kInf, -kInf});
    EXPECT_EQ(v.forward, 0.0);
    EXPECT_EQ(v.left, 0.0);
    EXPECT_EQ(v.turn, 0.0);
  }
}

}  // namespace
}  // namespace sf::robots
