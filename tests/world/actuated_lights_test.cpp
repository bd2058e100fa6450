// Actuated programs: calls, gaps, yellow, and the accuracy of forecasts.

#include "world/actuated_lights.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "world/fields.h"

namespace sf::world {
namespace {

/// Light a is green for 5 to 20 s while robots arrive; b on call.
struct Crossing {
  World world;
  LightPlan plan;

  Crossing() {
    for (const char* name : {"a", "b"}) {
      world.lights.emplace_back().name = name;
      world.lights.back().phases = {{LightState::dark, 1.0}};
    }
    plan = parse_light_plan("p.toml", R"(
[[detector]]
name = "at a"
at = [0, 0]
radius = 1
[[detector]]
name = "at b"
at = [10, 0]
radius = 1
calls = [[100, 101]]
[[program]]
lights = ["a", "b"]
[[program.stage]]
states = { a = "green" }
min = 5
max = 20
gap = 2
detectors = ["at a"]
[[program.stage]]
states = { b = "green" }
min = 4
max = 10
gap = 2
detectors = ["at b"]
on_call = true
)",
                            world);
  }
};

constexpr glm::dvec2 kAtA{0.5, 0.0}, kAtB{10.0, -1.0}, kElsewhere{5.0, 0.0};

/// Runs the lights in steps of 0.1 s, with robots at places for some time.
struct Drive : Crossing {
  ActuatedLights lights{world, plan};
  double time = 0.0;

  void until(double end, std::initializer_list<glm::dvec2> robots = {}) {
    for (; time < end - 1e-9; time += 0.1) {
      for (const glm::dvec2& p : robots) lights.detect(p, time);
      lights.step(time);
    }
  }
  LightState a() const { return lights.forecasts(time)[0].now.state; }
  LightState b() const { return lights.forecasts(time)[1].now.state; }
};

TEST(ActuatedLights, RestsInGreenWithoutACall) {
  Drive d;
  d.until(60.0, {kAtA, kElsewhere});
  EXPECT_EQ(d.a(), LightState::green);
  EXPECT_EQ(d.lights.forecasts(d.time)[0].now.left, HUGE_VAL) << "unknown without a call";
  EXPECT_EQ(d.b(), LightState::red);
}

TEST(ActuatedLights, CallEndsAnUnusedGreen) {
  Drive d;
  d.until(30.0);
  d.until(30.3, {kAtB});
  EXPECT_EQ(d.a(), LightState::yellow);
  EXPECT_EQ(d.b(), LightState::red);
  d.until(32.5, {kAtB});
  EXPECT_EQ(d.a(), LightState::red);
  EXPECT_EQ(d.b(), LightState::red) << "clear time";
  d.until(33.5, {kAtB});
  EXPECT_EQ(d.b(), LightState::green);
  // The robot has left: the stage ends after 4 s of green and a gap, and the call is cleared.
  d.until(36.9);
  EXPECT_EQ(d.b(), LightState::green);
  d.until(37.6);
  EXPECT_EQ(d.b(), LightState::yellow);
  d.until(70.0);
  EXPECT_EQ(d.a(), LightState::green);
}

TEST(ActuatedLights, RobotsExtendGreenUpToItsMaximum) {
  Drive d;
  d.until(19.8, {kAtA, kAtB});
  EXPECT_EQ(d.a(), LightState::green);
  d.until(20.3, {kAtA, kAtB});
  EXPECT_EQ(d.a(), LightState::yellow);
  Drive gap;
  gap.until(10.0, {kAtA, kAtB});
  gap.until(12.2, {kAtB});
  EXPECT_EQ(gap.a(), LightState::green) << "a state counts for 0.5 s, then the gap of 2 s";
  gap.until(12.8, {kAtB});
  EXPECT_EQ(gap.a(), LightState::yellow);
}

TEST(ActuatedLights, CallsOfTheFileCountAsRobots) {
  Drive d;
  d.until(99.9);
  EXPECT_EQ(d.a(), LightState::green);
  d.until(100.3);
  EXPECT_EQ(d.a(), LightState::yellow);
}

/// After the process was suspended, yellow is still shown in full, whatever was due.
TEST(ActuatedLights, LateStepDoesNotShortenYellow) {
  Drive d;
  d.until(10.0);
  d.time = 50.0;
  d.until(51.9, {kAtB});
  EXPECT_EQ(d.a(), LightState::yellow);
  d.until(52.3, {kAtB});
  EXPECT_EQ(d.a(), LightState::red);
}

std::string forecast_text(const SignalForecast& f) {
  const auto word = [](LightState state) {
    return std::string(words_of(LightState{})[static_cast<std::size_t>(state)]);
  };
  const std::string next = f.next ? fmt::format(", then {} for {:.1f}", word(f.next->state), f.next->left) : "";
  return fmt::format("{} for {:.1f} to {:.1f}{}", word(f.now.state), f.now.left, f.latest, next);
}

/// Robots at both lights for 25 s, then only at b until 40 s, then at neither.
TEST(ActuatedLights, ForecastsAreTheEarliestAndTheLatestChange) {
  struct Case {
    double second;
    const char* a;
    const char* b;
    const char* why;
  };
  Drive d;
  for (const Case& c :
       {Case{0, "green for inf to inf", "red for inf to inf", "no call"},
        {1, "green for 4.0 to 19.0, then yellow for 6.0", "red for 7.0 to 22.0, then green for inf", "both call"},
        {6, "green for 0.0 to 14.0, then yellow for 2.0", "red for 3.0 to 17.0, then green for inf", "after 'min'"},
        {20, "green for 0.0 to 0.0, then yellow for 2.0", "red for 3.0 to 3.0, then green for inf", "at 'max'"},
        {21, "yellow for 1.0 to 1.0, then red for inf", "red for 2.0 to 2.0, then green for inf", "a change"},
        {22, "red for inf to inf", "red for 1.0 to 1.0, then green for inf", "clear"},
        {24, "red for 6.0 to 12.0, then green for inf", "green for 3.0 to 9.0, then yellow for 5.0", "the next"},
        {34, "red for 2.0 to 2.0, then green for inf", "yellow for 1.0 to 1.0, then red for inf", "back"},
        {37, "green for 4.0 to 19.0, then yellow for 6.0", "red for 7.0 to 22.0, then green for inf", "b calls"},
        {49, "red for 2.0 to 2.0, then green for inf", "yellow for 1.0 to 1.0, then red for inf", "a gap"},
        {52, "green for inf to inf", "red for inf to inf", "at rest"}}) {
    d.until(std::min(c.second, 25.0), {kAtA, kAtB});
    d.until(std::min(c.second, 40.0), {kAtB});
    d.until(c.second);
    const std::vector<SignalForecast> all = d.lights.forecasts(d.time);
    EXPECT_EQ(forecast_text(all[0]), c.a) << c.second << " s: " << c.why;
    EXPECT_EQ(forecast_text(all[1]), c.b) << c.second << " s: " << c.why;
  }
}

/// Random robots for half an hour: never two greens, yellow between green and red, and no change before its forecast.
TEST(ActuatedLights, ForecastsAndYellowHold) {
  Drive d;
  std::vector<SignalForecast> before = d.lights.forecasts(0.0);
  double sooner[2] = {0.0, 0.0};  // [s] no change was forecast before this time
  int greens = 0;
  for (std::uint32_t k = 0; k < 18'000; ++k) {
    const auto u = base::random_uniform({.seed = 5, .stream = base::RandomStream::placement, .a = k / 40}, 0);
    if (u[0] < 0.4) d.lights.detect(kAtA, d.time);
    if (u[1] < 0.4) d.lights.detect(kAtB, d.time);
    d.lights.step(d.time);
    const std::vector<SignalForecast> now = d.lights.forecasts(d.time);
    EXPECT_FALSE(now[0].now.state != LightState::red && now[1].now.state != LightState::red) << d.time;
    for (std::size_t i = 0; i < 2; ++i) {
      const LightState was = before[i].now.state, is = now[i].now.state;
      EXPECT_FALSE(was == LightState::green && is == LightState::red) << "without yellow at " << d.time;
      EXPECT_TRUE(was == is || d.time >= sooner[i] - 1e-6) << "light " << i << " changed early at " << d.time;
      if (was != is && is == LightState::green) ++greens;
      EXPECT_GE(now[i].latest, now[i].now.left);
      sooner[i] = std::isfinite(now[i].now.left) ? d.time + now[i].now.left : 0.0;
    }
    before = now;
    d.time += 0.1;
  }
  EXPECT_GT(greens, 60) << "the lights work";
}

}  // namespace
}  // namespace sf::world
