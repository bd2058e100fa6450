#include "robots/command_law.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "tests/units.h"

namespace sf::robots {
namespace {

using base::Twist;

world::Mover create() {
  world::Mover mover;
  mover.track = 0.258;
  mover.actuator_model = world::ActuatorModel::player_create;
  return mover;
}

void expect_twist(const Twist& actual, const Twist& expected) {
  EXPECT_DOUBLE_EQ(actual.forward, expected.forward);
  EXPECT_DOUBLE_EQ(actual.left, expected.left);
  EXPECT_DOUBLE_EQ(actual.turn, expected.turn);
}

TEST(ActuatorModel, DirectReturnsTheCommand) {
  expect_twist(apply_actuator_model(world::Mover{}, {0.1234, 0.2, -3.3}), {0.1234, 0.2, -3.3});
}

TEST(ActuatorModel, NonFiniteCommandsBecomeZero) {
  expect_twist(apply_actuator_model(world::Mover{}, {kNaN, kInf, 1.0}), {0.0, 0.0, 1.0});
  expect_twist(apply_actuator_model(create(), {kNaN, kInf, -kInf}), {0.0, 0.0, 0.0});
}

// The cases of Player's driver, with radii computed by hand.
TEST(ActuatorModel, CreateReceivesWholeMillimetres) {
  expect_twist(apply_actuator_model(create(), {0.1234, 0.0, 0.0}), {0.123, 0.0, 0.0});     // 123 mm/s, straight
  expect_twist(apply_actuator_model(create(), {0.7, 0.0, 0.0}), {0.5, 0.0, 0.0});          // largest speed
  expect_twist(apply_actuator_model(create(), {-0.7, 0.0, 0.0}), {-0.5, 0.0, 0.0});        // largest reverse speed
  expect_twist(apply_actuator_model(create(), {0.1, 0.3, 0.0}), {0.1, 0.0, 0.0});          // no lateral motion
  expect_twist(apply_actuator_model(create(), {0.1, 0.0, 0.1}), {0.1, 0.0, 0.1 / 0.5});    // 1000 mm, halved
  expect_twist(apply_actuator_model(create(), {0.1, 0.0, -0.1}), {0.1, 0.0, -0.1 / 0.5});  // to the right
  expect_twist(apply_actuator_model(create(), {-0.1, 0.0, 0.1}), {-0.1, 0.0, 0.1 / 0.5});  // backwards: radius -500
  expect_twist(apply_actuator_model(create(), {0.1, 0.0, 0.03}),
               {0.1, 0.0, 0.1 / 1.666});  // 3333 / 2: truncated, not rounded
  expect_twist(apply_actuator_model(create(), {0.1, 0.0, -0.03}), {0.1, 0.0, -0.1 / 1.666});  // towards zero
  expect_twist(apply_actuator_model(create(), {0.1, 0.0, 0.001}), {0.1, 0.0, 0.1 / 2.0});     // clamped to 2 m
  expect_twist(apply_actuator_model(create(), {0.1, 0.0, -1e-300}), {0.1, 0.0, -0.1 / 2.0});  // for any small turn
  expect_twist(apply_actuator_model(create(), {0.1, 0.0, 25.0}), {0.1, 0.0, 0.1 / 0.002});    // 4 mm, halved
  expect_twist(apply_actuator_model(create(), {0.0001, 0.0, 0.5}), {0.0, 0.0, 0.0});  // rounds to 0 mm/s: at rest
}

TEST(ActuatorModel, CreateSpinsWhenTheRadiusVanishes) {
  expect_twist(apply_actuator_model(create(), {0.1, 0.0, 50.0}),
               {0.0, 0.0, 0.1 / 0.129});  // 2 mm halved is 1: the code for a spin
  expect_twist(apply_actuator_model(create(), {0.1, 0.0, 100.0}), {0.0, 0.0, 0.1 / 0.129});  // 1 mm halved is 0: same
  expect_twist(apply_actuator_model(create(), {0.1, 0.0, -100.0}), {0.0, 0.0, -0.1 / 0.129});
  expect_twist(apply_actuator_model(create(), {-0.1, 0.0, 100.0}), {0.0, 0.0, 0.1 / 0.129});
}

TEST(ActuatorModel, CreateSpinsInPlaceAtWholeWheelMillimetres) {
  expect_twist(apply_actuator_model(create(), {0.0, 0.0, 1.0}), {0.0, 0.0, 0.129 / 0.129});
  expect_twist(apply_actuator_model(create(), {0.0, 0.0, -1.001}), {0.0, 0.0, -0.129 / 0.129});
  expect_twist(apply_actuator_model(create(), {0.0, 0.0, 100.0}), {0.0, 0.0, 0.5 / 0.129});
  expect_twist(apply_actuator_model(create(), {0.0, 0.0, 0.003}),
               {0.0, 0.0, 0.0});  // less than half a millimetre per second
}

TEST(ActuatorModel, CreateTurnsAboutTwiceAsMuchAsCommanded) {
  for (std::uint32_t k = 0; k < 2000; ++k) {
    const auto u = base::random_uniform({.seed = 11, .stream = base::RandomStream::slip, .a = k}, 0);
    const double forward = 0.05 + 0.45 * u[0], turn = (u[1] < 0.5 ? -1.0 : 1.0) * (0.02 + std::abs(u[1] - 0.5));
    const Twist v = apply_actuator_model(create(), {forward, 0.0, turn});
    EXPECT_NEAR(v.forward, forward, 5e-4);
    EXPECT_EQ(v.turn > 0.0, turn > 0.0);
    EXPECT_GE(std::abs(v.turn), v.forward / 2.0 * (1.0 - 1e-12)) << "the widest bend has a radius of 2 m";
    if (std::abs(forward / turn) > 3.9) continue;
    EXPECT_NEAR(v.turn / turn, 2.0, 0.15);
  }
}

}  // namespace
}  // namespace sf::robots
