#include "world/lights.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sf::world {
namespace {

Light plan() {
  Light light;
  light.phases = {{LightState::green, 8.0}, {LightState::yellow, 2.0}, {LightState::red, 14.0}};
  light.offset = 5.0;
  return light;
}

TEST(SignalAt, EachPhaseBeginsAtTheEndOfThePrevious) {
  const Light light = plan();
  EXPECT_EQ(signal_at(light, 5.0).state, LightState::green);
  EXPECT_EQ(signal_at(light, 5.0).left, 8.0);
  EXPECT_EQ(signal_at(light, 12.5).state, LightState::green);
  EXPECT_EQ(signal_at(light, 12.5).left, 0.5);
  EXPECT_EQ(signal_at(light, 13.0).state, LightState::yellow);
  EXPECT_EQ(signal_at(light, 15.0).state, LightState::red);
  EXPECT_EQ(signal_at(light, 29.0).state, LightState::green) << "and over again";
  EXPECT_EQ(signal_at(light, 5.0 + 24.0 * 1e6 + 9.0).state, LightState::yellow);
}

/// Half a second into each second of a whole turn, counted in integers. Doubles are 4 ns apart there.
TEST(SignalAt, KeepsItsPlanForAYear) {
  constexpr std::int64_t kYear = 31'556'952;  // [s]
  for (std::int64_t second = kYear; second < kYear + 24; ++second) {
    const std::int64_t into = (second - 5) % 24, end = into < 8 ? 8 : into < 10 ? 10 : 24;
    const Signal signal = signal_at(plan(), static_cast<double>(second) + 0.5);
    EXPECT_EQ(signal.state, into < 8 ? LightState::green : into < 10 ? LightState::yellow : LightState::red) << second;
    EXPECT_NEAR(signal.left, static_cast<double>(end - into) - 0.5, 1e-7) << second;
  }
}

TEST(SignalAt, PlanAlsoRunsBeforeItsOffset) {
  EXPECT_EQ(signal_at(plan(), 4.0).state, LightState::red);
  EXPECT_EQ(signal_at(plan(), 4.0).left, 1.0);
  EXPECT_EQ(signal_at(plan(), 5.0 - 24.0).state, LightState::green);
}

TEST(SignalAt, OnePhaseNeverChanges) {
  Light light;
  light.phases = {{LightState::flashing_red, 3.0}};
  EXPECT_EQ(signal_at(light, 100.0).state, LightState::flashing_red);
  EXPECT_EQ(signal_at(light, 100.0).left, HUGE_VAL);
}

TEST(SignalAt, TimeLeftIsTheTimeToTheNextPhase) {
  for (std::uint32_t k = 0; k < 2000; ++k) {
    const auto u = base::random_uniform({.seed = 3, .stream = base::RandomStream::placement, .a = k}, 0);
    Light light = plan();
    light.phases[0].duration = 0.1 + u[1];
    const double time = 1000.0 * (u[0] - 0.5);
    const Signal now = signal_at(light, time);
    ASSERT_GT(now.left, 0.0);
    EXPECT_EQ(signal_at(light, time + 0.999 * now.left).state, now.state);
    EXPECT_NE(signal_at(light, time + now.left + 1e-6).state, now.state);
  }
}

}  // namespace
}  // namespace sf::world
