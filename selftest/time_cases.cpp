// Ticks of 1 us and of 10 s, tick 1e9, a year.

#include <fmt/format.h>

#include "base/time.h"
#include "farm/schedule.h"
#include "robots/fleet.h"
#include "robots/kinematics.h"
#include "selftest/suite.h"
#include "sensors/laser_reference.h"
#include "world/lights.h"

namespace sf::selftest {

namespace {

constexpr std::int64_t kYear = 31'556'952 * base::kSecond;
constexpr std::uint64_t kSeed = 5;

world::World noisy_room() {
  world::World world;
  add_room(world, {-2.0, -2.0}, 4.0);
  sensors::LaserSettings eye = laser(61, 3.0, 8.0);
  eye.noise = {.range_sigma = 0.01, .angle_sigma = 0.001};
  add_laser_mover(world, {0.2, 0.1, 0.0, 0.0}, eye);
  return world;
}

/// Compares a reading at `now` [ns] and its sequence number with plain C++.
void read_at(const Fixture& fixture, TestFarm& test, Checks& checks, std::int64_t now, std::uint64_t number,
             const std::string& what) {
  const auto readings = test.farm->tick(now, {});
  checks.equal(readings.size(), 1u, what + ": readings");
  if (readings.empty()) return;
  checks.equal(readings[0].sequence, number, what + ": number");
  checks.equal(readings[0].time, now, what + ": time");
  const auto exact = sensors::LaserReference(*test.world, kSeed).scan(0, 0, number);
  const double allowed = allowed_from_plain_cpp(fixture, test, readings[0]);
  for (std::size_t i = 0; i < exact.ranges.size(); ++i)
    check_range(readings[0].values[i], exact.ranges[i], allowed, checks, what, i);
}

void tick_1e9(Fixture& fixture, Checks& checks) {
  TestFarm test = fixture.measure(noisy_room(), {.seed = kSeed});
  read_at(fixture, test, checks, kYear, 315'569'520u, "after a year");
  read_at(fixture, test, checks, 1'000'000'000ll * (base::kSecond / 10), 1'000'000'000u, "tick 1e9");
  read_at(fixture, test, checks, 1'000'000'001ll * (base::kSecond / 10), 1'000'000'001u, "the one after");
}

/// Periods of whole nanoseconds, checked with integers.
void due_for_a_year(Fixture&, Checks& checks) {
  for (const std::int64_t rate : {1, 10, 50, 1000, 1'000'000}) {
    const std::int64_t period = base::kSecond / rate;
    for (std::int64_t i = 0; i < 2000; ++i) {
      const std::int64_t k = kYear / period + 7919 * i;
      const auto what = fmt::format("{} Hz, reading {}", rate, k);
      checks.equal(farm::readings_started(k * period, static_cast<double>(rate), 0.0), k + 1, what + " is due");
      checks.equal(farm::readings_started(k * period - 2, static_cast<double>(rate), 0.0), k,
                   what + " is not, 2 ns before");
    }
  }
}

void microsecond_ticks(Fixture& fixture, Checks& checks) {
  TestFarm test = fixture.measure(noisy_room(), {.seed = kSeed});
  constexpr std::int64_t kMicrosecond = 1000;
  std::vector<std::int64_t> times;
  for (std::int64_t tick = 1; tick <= 200'001; ++tick)
    for (const base::ReadingBlock& r : test.farm->tick(tick * kMicrosecond, {})) times.push_back(r.time);
  checks.equal(times.size(), 2u, "readings in 0.2 s");
  for (std::size_t i = 0; i < times.size(); ++i)
    checks.equal(times[i], static_cast<std::int64_t>(i + 1) * base::kSecond / 10, "each at its time", i);
}

void ten_second_ticks(Fixture& fixture, Checks& checks) {
  TestFarm test = fixture.measure(noisy_room(), {.seed = kSeed});
  for (std::int64_t tick = 1; tick <= 100; ++tick)
    read_at(fixture, test, checks, tick * 10 * base::kSecond, static_cast<std::uint64_t>(100 * tick), "every 10 s");
}

/// A circle of 1 m radius at 0.3 m/s, in steps of 1 us for a second and in one step of 10 s. Each step rounds a pose
/// three times by half a grain of 2 m, and the errors of the steps accumulate.
void motion(Fixture&, Checks& checks) {
  const base::Twist twist{0.3, 0.0, 0.3};
  const auto expect = [&](const base::Pose& X, Real seconds, double allowed, const std::string& what) {
    const Real angle = Real{0.3} * seconds;
    checks.near(X.x, std::sin(angle), allowed, what + ": x");
    checks.near(X.y, 1 - std::cos(angle), allowed, what + ": y");
    checks.near(X.yaw, std::remainder(angle, 2 * std::acos(Real{-1})), allowed, what + ": yaw");
  };
  base::Pose X;
  for (int i = 0; i < 1'000'000; ++i) X = robots::advance(X, twist, 1e-6);
  expect(X, 1, 1e6 * 3 * 2.2e-16, "a million steps of 1 us");
  expect(robots::advance({}, twist, 10.0), 10, 1e-14, "one step of 10 s");

  world::World world;
  add_mover(world, {});
  const base::Twist turning{0.3, 0.0, 0.3};
  for (const auto& [dt, steps] : {std::pair<std::int64_t, int>{1000, 100'000}, {10 * base::kSecond, 1}}) {
    robots::Fleet fleet(world);
    for (int i = 0; i < steps; ++i) fleet.move({&turning, 1}, dt);
    const Real seconds = static_cast<Real>(dt * steps) * 1e-9L;
    expect(fleet.reports()[0].X_WM, seconds, 1e5 * 3 * 2.2e-16, fmt::format("a fleet's ticks of {} ns", dt));
  }
}

/// Plans of whole seconds, sampled half a second into each, checked with integers.
void lights(Fixture&, Checks& checks) {
  using State = world::LightState;
  const world::Light light{.phases = {{State::green, 8.0}, {State::yellow, 2.0}, {State::red, 10.0}}, .offset = 3.0};
  for (std::int64_t second = kYear / base::kSecond; second < kYear / base::kSecond + 100; ++second) {
    const std::int64_t into = (second - 3) % 20;
    const world::Signal signal = world::signal_at(light, static_cast<double>(second) + 0.5);
    const State expected = into < 8 ? State::green : into < 10 ? State::yellow : State::red;
    checks.holds(signal.state == expected, "the lamp after a year", static_cast<std::uint64_t>(second));
    const double left = static_cast<double>(into < 8 ? 8 - into : into < 10 ? 10 - into : 20 - into) - 0.5;
    checks.near(signal.left, left, 1e-7, "and how long it lasts", static_cast<std::uint64_t>(second));
  }
}

constexpr Case kTimeCases[] = {
    {"times", "tick-1e9", "m", "readings after a year and at tick 1e9, with noise: plain C++'s to the bit", tick_1e9},
    {"times", "due-for-a-year", "", "readings due after a year at 1 Hz to 1 MHz: counted in integers, to 2 ns",
     due_for_a_year},
    {"times", "ticks-of-1-us", "", "200 001 ticks of 1 us: two readings of a 10 Hz laser, each at its nanosecond",
     microsecond_ticks},
    {"times", "ticks-of-10-s", "m", "ticks of 10 s: one reading each, the latest due, plain C++'s to the bit",
     ten_second_ticks},
    {"times", "motion", "m, rad", "an arc in steps of 1 us and of 10 s: sine and cosine, three roundings a step",
     motion},
    {"times", "lights-for-a-year", "s",
     "a traffic light's plan after a year: counted in integers, doubles of 4 ns there", lights},
};

}  // namespace

std::span<const Case> time_cases() { return kTimeCases; }

}  // namespace sf::selftest
