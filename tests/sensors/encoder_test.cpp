// Wheel encoders: exact along arcs, quantised, with slip as a random walk over distance.

#include "sensors/encoder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sensors/odometer.h"
#include "tests/sensors/host_trial.h"
#include "tests/sensors/statistics.h"

namespace sf::trial {
namespace {

using base::Pose;
using sensors::read_encoder;
using sensors::roll;
using sensors::Rolled;
using sensors::Slippage;

/// Returns the pose of a wheel pair after rolling `left` and `right` from `from`: the textbook arc around its centre.
Pose driven(const Pose& from, double left, double right, double track) {
  const long double turn = (static_cast<long double>(right) - left) / track,
                    arc = (static_cast<long double>(left) + right) / 2;
  const long double yaw = from.yaw;
  if (std::abs(turn) < 1e-12L)
    return {static_cast<double>(from.x + arc * std::cos(yaw)), static_cast<double>(from.y + arc * std::sin(yaw)), 0,
            from.yaw};
  const long double radius = arc / turn;
  return {static_cast<double>(from.x + radius * (std::sin(yaw + turn) - std::sin(yaw))),
          static_cast<double>(from.y - radius * (std::cos(yaw + turn) - std::cos(yaw))), 0,
          static_cast<double>(yaw + turn)};
}

// --- Arcs.

TEST(Odometer, InvertsAnyArc) {
  Chance chance(1);
  for (int i = 0; i < 2000; ++i) {
    const double track = chance.between(0.05, 1.0);
    const double turn = i % 4 == 0 ? chance.between(-1e-6, 1e-6) : chance.between(-3.1, 3.1);
    const double arc = chance.between(-2.0, 2.0);
    const double left = arc - 0.5 * track * turn, right = arc + 0.5 * track * turn;
    const Pose from{chance.between(-9, 9), chance.between(-9, 9), 0, chance.between(-9, 9)};
    Pose to = driven(from, left, right, track);
    if (i % 3 == 0) to.yaw = base::wrap_angle(to.yaw);
    if (i % 3 == 1) to.yaw += 2 * M_PI;
    const Rolled rolled = roll(from, to, track);
    EXPECT_NEAR(rolled.left, left, 1e-9) << turn;
    EXPECT_NEAR(rolled.right, right, 1e-9) << turn;
  }
}

TEST(Odometer, BoundaryCases) {
  const auto expect = [](const Rolled& r, double left, double right, const char* why) {
    EXPECT_NEAR(r.left, left, 1e-12) << why;
    EXPECT_NEAR(r.right, right, 1e-12) << why;
  };
  expect(roll({1, 2, 0, 3}, {1, 2, 0, 3}, 0.5), 0, 0, "at rest");
  expect(roll({0, 0, 0, 0}, {0, 0, 0, 1}, 0.5), -0.25, 0.25, "turning in place");
  expect(roll({0, 0, 0, 3.1}, {0, 0, 0, -3.1}, 1.0), -M_PI + 3.1, M_PI - 3.1, "through straight behind");
  expect(roll({0, 0, 0, 0}, {-0.3, 0, 0, 0}, 0.5), -0.3, -0.3, "backwards");
  expect(roll({0, 0, 0, 0}, {0, 0.3, 0, 0}, 0.5), 0, 0, "pushed to the side");
  expect(roll({0, 0, 0, 0}, {0, 2, 0, M_PI}, 1.0), M_PI - M_PI / 2, M_PI + M_PI / 2, "half a turn about (0, 1)");
}

// --- Slippage.

TEST(Odometer, SlippageDoesNotDependOnStepSizes) {
  const base::RandomKey walk{3, base::RandomStream::slip, 1, 2};
  Slippage whole(walk, 0, 0.01), cut(walk, 0, 0.01), other(walk, 1, 0.01);
  Chance chance(2);
  double way = 0.0;
  while (way < 5.0) {
    const double piece = chance.between(0.0, 0.03);
    cut.advance(piece);
    way += piece;
  }
  whole.advance(way);
  other.advance(way);
  EXPECT_NEAR(whole.error(), cut.error(), 1e-9);
  EXPECT_NE(whole.error(), 0.0);
  EXPECT_GT(std::abs(whole.error() - other.error()), 1e-6) << "wheels slip by themselves";
}

TEST(Odometer, SlippageVarianceGrowsWithDistance) {
  constexpr double kSlip = 0.02;
  for (const double way : {0.01, 0.25, 1.0, 4.0, 1e9}) {  // a long distance is one step
    std::vector<double> draws;
    for (std::uint32_t robot = 0; robot < 2000; ++robot) {
      Slippage slippage({7, base::RandomStream::slip, robot, 0}, 0, kSlip);
      for (int k = 0; k < 5; ++k) slippage.advance(way / 5);
      draws.push_back(slippage.error() / (kSlip * std::sqrt(way)));
    }
    EXPECT_LT(ks(draws), 1.95) << way;
  }
}

// --- The sensor.

world::World one_robot(std::vector<world::Setting> settings = {}, double max_forward = 1.0) {
  world::World world = carriers(fitted("encoder", std::move(settings)));
  world.movers[0].track = 0.26;
  world.movers[0].max_forward = max_forward;
  return world;
}

/// Drives robot 0 by its wheels' distances in ticks of 0.1 s. @return the last reading
std::vector<double> drive(const world::World& world, const std::vector<Rolled>& wheels,
                          farm::FarmOptions options = {}) {
  farm::Farm farm(world, device(), options);
  farm.subscribe_all();
  std::vector<base::Report> states = robots::states_at_load(world);
  std::vector<double> last;
  std::int64_t now = 0;
  for (const Rolled& r : wheels) {
    states[0].X_WM = driven(states[0].X_WM, r.left, r.right, world.movers[0].track);
    states[0].time = now;
    last = values_of(farm.tick(now, states)[0]);
    now += 100'000'000;
  }
  return last;
}

/// A slipping wheel counts more than the robot advances; on a slope the way is the longer one.
TEST(Encoder, WheelsSlipByARatioAndOnSlopes) {
  const sensors::Encoder flat{.per_count = 1e-9, .track = 0.5, .slip_ratio_left = 0.2, .slip_ratio_right = -0.25};
  const auto rolled = [](sensors::Encoder encoder, double x, double slip, double rise) {
    sensors::Wheels wheels(encoder, {}, false);
    wheels.roll({}, {x, 0.0, rise, 0.0}, slip, rise);
    return wheels.rolled;
  };
  EXPECT_DOUBLE_EQ(rolled(flat, 1.0, 0.0, 0.0).left, 1.25);
  EXPECT_DOUBLE_EQ(rolled(flat, 1.0, 0.0, 0.0).right, 0.8) << "a wheel that is dragged";
  EXPECT_DOUBLE_EQ(rolled(flat, -1.0, 0.0, 0.0).left, -1.25) << "backwards";
  EXPECT_DOUBLE_EQ(rolled(flat, 1.0, 0.5, 0.0).left, 2.5) << "with the slip of the run";

  const sensors::Encoder hill{.track = 0.5, .slope_slip = 0.5};
  EXPECT_DOUBLE_EQ(rolled({.track = 0.5}, 0.4, 0.0, 0.3).left, 0.5) << "along the slope";
  EXPECT_DOUBLE_EQ(rolled(hill, 0.4, 0.0, 0.3).left, 0.5 / (1.0 - 0.5 * 0.6)) << "uphill";
  EXPECT_DOUBLE_EQ(rolled(hill, -0.4, 0.0, 0.3).left, -0.5 / (1.0 - 0.5 * 0.6)) << "uphill, backwards";
  EXPECT_DOUBLE_EQ(rolled(hill, 0.4, 0.0, -0.3).left, 0.5 / (1.0 + 0.5 * 0.6)) << "downhill";
  EXPECT_DOUBLE_EQ(rolled({.track = 0.5, .slope_slip = 10.0}, 0.4, 0.0, 0.3).left, 5.0) << "at most 0.9";

  expect_refused("encoder", {setting("slip_ratio", {0, 0.95})}, 8, "expected [left right], from -0.9 to 0.9");
  expect_refused("encoder", {setting("slope_slip", {-1})}, 8, "'slope_slip'");
}

/// Robots on slopes are tilted; level ones that are lifted do not drive.
TEST(Encoder, OnlyTiltedRobotsClimb) {
  for (const double pitch : {0.0, -0.5}) {
    const world::World world = one_robot({setting("per_count", {1e-6})});
    farm::Farm farm(world, device());
    farm.subscribe_all();
    std::vector<base::Report> states = robots::states_at_load(world);
    farm.tick(0, states);
    states[0].X_WM = {0.4, 0.0, 0.3, 0.0};
    states[0].tilt.pitch = pitch;
    states[0].time = 500'000'000;
    EXPECT_NEAR(farm.tick(500'000'000, states)[0].values[0], pitch == 0.0 ? 0.4 : 0.5, 1e-6);
  }
}

TEST(Encoder, CountsBothWheels) {
  const std::vector<double> r = drive(one_robot(), std::vector<Rolled>(100, {0.03, 0.05}));
  ASSERT_EQ(r.size(), 4u);
  EXPECT_EQ(r[2], 3000.0) << "millimetres";
  EXPECT_EQ(r[3], 5000.0);
  EXPECT_DOUBLE_EQ(r[0], 3.0);
  EXPECT_DOUBLE_EQ(r[1], 5.0);
}

TEST(Encoder, QuantisesToCounts) {
  Chance chance(4);
  const double count = 1e-3 / 12;
  for (int i = 0; i < 50; ++i) {
    const Rolled rolled{chance.between(-0.2, 0.2), chance.between(-0.2, 0.2)};
    const std::vector<double> r = drive(one_robot({setting("per_count", {count})}), {rolled});
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(r[k + 2], std::floor(r[k + 2]));
      EXPECT_DOUBLE_EQ(r[k], r[k + 2] * count);
    }
    EXPECT_NEAR(r[0], rolled.left, 0.5001 * count);
    EXPECT_NEAR(r[1], rolled.right, 0.5001 * count);
  }
}

TEST(Encoder, ScrubWidensTheTrack) {
  world::World world = one_robot();
  world.movers[0].drive = world::Drive::skid;
  const double turn = 2.0;
  std::vector<double> r = drive(world, {{-0.13 * turn, 0.13 * turn}});
  EXPECT_EQ(r[3], std::round(1500 * 0.13 * turn));
  EXPECT_EQ(r[2], -r[3]);
  r = drive(one_robot({setting("scrub", {2.0}), setting("track", {0.5})}), {{-0.13 * turn, 0.13 * turn}});
  EXPECT_EQ(r[3], 1000 * 0.5 * turn);
  r = drive(one_robot({setting("scrub", {2.0})}), {{0.1, 0.1}});
  EXPECT_EQ(r[3], 100.0) << "no scrub on a straight line";
}

TEST(Encoder, ScaleChangesTheCounts) {
  const std::vector<double> r = drive(one_robot({setting("scale", {1.01, 0.99})}), {{0.2, 0.2}});
  EXPECT_EQ(r[2], 202.0);
  EXPECT_EQ(r[3], 198.0);
}

/// Speeds of wheels count in place of the path: a locked wheel, and one that spins, of a robot at rest. Between ticks,
/// too. Without them (an obstacle stopped the car), the path counts again.
TEST(Encoder, CountsTheWheelsOfCars) {
  const world::World world = one_robot({setting("rate", {20})});
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::vector<base::Report> states = robots::states_at_load(world);
  farm.tick(0, states);
  states[0].time = 100'000'000, states[0].wheels = {0.0f, 2.0f};
  const std::vector<double> half = values_of(farm.sample_between(50'000'000, states)[0]);
  EXPECT_EQ(half[2], 0.0);
  EXPECT_EQ(half[3], 100.0);
  EXPECT_EQ(farm.tick(100'000'000, states)[0].values[3], 200.0);
  states[0].time = 200'000'000, states[0].X_WM.x = 0.05, states[0].wheels = {};
  const std::vector<double> stopped = values_of(farm.tick(200'000'000, states)[0]);
  EXPECT_EQ(stopped[2], 50.0);
  EXPECT_EQ(stopped[3], 250.0);

  world::World car = one_robot({setting("slip_ratio", {0, 0})});
  car.movers[0].dynamics.name = "car";
  expect_in("'dynamics \"car\"' compute their slip; leave 'slip_ratio' out",
            refusal_of([&] { sensors::SensorSet sensor_set(car); }));
}

/// Slip in readings as a distribution; the fine resolution avoids quantisation.
TEST(Encoder, SlipHasTheFilesDeviationAfterAMetre) {
  world::World world;
  for (int i = 0; i < 500; ++i)
    scenes::add_carrier(world, {0, 1.0 * i, 0, 0},
                        fitted("encoder", {setting("slip", {0.05}), setting("per_count", {1e-6})}));
  for (world::Mover& mover : world.movers) mover.max_forward = 1.0;
  farm::Farm farm(world, device(), {.seed = 11}), quiet(world, device(), {.noise = false});
  farm.subscribe_all();
  quiet.subscribe_all();
  std::vector<base::Report> states = robots::states_at_load(world);
  for (int tick = 0; tick < 20; ++tick) {
    for (base::Report& s : states) s.X_WM.x += 0.05;
    const auto readings = farm.tick(tick * 100'000'000ll, states), still = quiet.tick(tick * 100'000'000ll, states);
    if (tick < 19) continue;
    std::vector<double> left, right;
    for (const auto& r : readings) {
      left.push_back((r.values[0] - 1.0) / 0.05);
      right.push_back((r.values[1] - 1.0) / 0.05);
    }
    for (const auto& r : still) EXPECT_NEAR(r.values[0], 1.0, 1e-6) << "without noise nothing slips";
    EXPECT_LT(ks(left), 1.95);
    EXPECT_LT(ks(right), 1.95);
    EXPECT_LT(std::abs(correlation(left, right)), 4.0 / std::sqrt(500.0));
    EXPECT_LT(std::abs(correlation(left, left, 1)), 4.0 / std::sqrt(500.0));
  }
}

/// Each wheel slips over its own distance, in either direction.
TEST(Encoder, WheelsSlipOverTheirOwnDistance) {
  const auto world = one_robot({setting("slip", {0.05}), setting("per_count", {1e-6})});
  for (const double way : {0.05, -0.05}) {
    std::vector<double> r = drive(world, std::vector<Rolled>(10, {0.0, way}), {.seed = 5});
    EXPECT_NEAR(r[0], 0.0, 1e-9) << "at rest";
    EXPECT_GT(std::abs(r[1] - 10 * way), 1e-4);
    r = drive(world, std::vector<Rolled>(10, {way, 0.0}), {.seed = 5});
    EXPECT_GT(std::abs(r[0] - 10 * way), 1e-4);
    EXPECT_NEAR(r[1], 0.0, 1e-9);
  }
}

/// A reading between two ticks is current. The next tick continues from the last one, bit by bit.
TEST(Encoder, ReadsBetweenTicksAndContinuesFromTheLastTick) {
  const world::World world = one_robot({setting("per_count", {1e-6}), setting("slip", {0.02}), setting("rate", {50})});
  farm::Farm often(world, device(), {.seed = 2}), seldom(world, device(), {.seed = 2});
  for (farm::Farm* farm : {&often, &seldom}) farm->subscribe_all();
  std::vector<base::Report> states = robots::states_at_load(world);
  double last = 0.0;
  for (std::int64_t tick = 0; tick < 200; ++tick) {
    const double x = 0.0731 * static_cast<double>(tick);
    for (const std::int64_t ms : {20, 60}) {
      if (tick == 0) continue;
      states[0].X_WM = {x - 0.0731 + 1e-2 * 0.0731 * static_cast<double>(ms), 0, 0, 0};
      const auto readings = often.sample((tick - 1) * 100'000'000 + ms * 1'000'000, states);
      ASSERT_EQ(readings.size(), 1u);
      EXPECT_GT(readings[0].values[0], last - 1e-2);
      EXPECT_NEAR(readings[0].values[0], states[0].X_WM.x, 0.02 * 5.0 * std::sqrt(x + 0.01));
      last = readings[0].values[0];
    }
    states[0].X_WM = {x, 0, 0, 0};
    const auto p = values_of(often.tick(tick * 100'000'000, states)[0]);
    EXPECT_EQ(p, values_of(seldom.tick(tick * 100'000'000, states)[0])) << tick;
  }
}

/// Distances between ticks without slip: relocations do not count, driven distances do.
TEST(Encoder, IgnoresRelocationsBetweenTicks) {
  const world::World world = one_robot({setting("rate", {50})}, 1.0);
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::vector<base::Report> states = robots::states_at_load(world);
  const auto counts = [&](std::int64_t ms, double x) {
    states[0].X_WM.x = x;
    const auto readings = ms % 100 == 0 ? farm.tick(ms * 1'000'000, states) : farm.sample(ms * 1'000'000, states);
    return readings[0].values[2];
  };
  EXPECT_EQ(counts(0, 0.0), 0.0);
  EXPECT_EQ(counts(20, 0.02), 20.0);
  EXPECT_EQ(counts(40, 0.04), 40.0) << "from the tick, not on top of the last reading";
  EXPECT_EQ(counts(60, 9.0), 0.0) << "as at the tick: it cannot have driven there";
  EXPECT_EQ(counts(100, 0.1), 100.0);
  EXPECT_EQ(counts(120, 0.1), 100.0) << "at rest";
}

/// The largest possible displacement is measured from the last tick, regardless of samples in between, including for
/// the first move.
TEST(Encoder, ReadingsBetweenTicksDoNotCauseRelocations) {
  const world::World world = one_robot({setting("rate", {50})}, 1.0);
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::vector<base::Report> states = robots::states_at_load(world);
  farm.tick(0, states);
  farm.sample(80'000'000, states);
  states[0].X_WM.x = 0.6;
  EXPECT_EQ(farm.tick(100'000'000, states)[0].values[2], 600.0) << "half a metre, and twice its speed";
}

/// An absent robot's wheels do not roll. After its return they continue from its last pose.
TEST(Encoder, StopsWhileTheRobotIsAbsent) {
  const world::World world = one_robot({setting("rate", {50})}, 1.0);
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::vector<base::Report> states = robots::states_at_load(world);
  states[0].X_WM.x = 0.1;
  EXPECT_EQ(farm.tick(100'000'000, states)[0].values[2], 100.0);
  farm.set_absent(0, true);
  EXPECT_TRUE(farm.tick(200'000'000, states).empty());
  farm.set_absent(0, false);
  farm.subscribe_all();
  states[0].X_WM.x = 0.2;
  EXPECT_EQ(farm.tick(300'000'000, states)[0].values[2], 200.0);
}

/// Fast robots exceed half a metre per tick: twice the distance at their top speed still counts as driven.
TEST(Encoder, FastDrivingIsNotARelocation) {
  for (const double max_forward : {1.0, 10.0, 30.0}) {
    const world::World world = one_robot({}, max_forward);
    farm::Farm farm(world, device());
    farm.subscribe_all();
    std::vector<base::Report> states = robots::states_at_load(world);
    double x = 0.0, rolled = 0.0;
    for (std::int64_t tick = 0; tick < 30; ++tick) {
      const double way = tick == 0 ? 0.0 : tick < 20 ? 0.1 * max_forward : 0.49 + 0.2 * max_forward;
      states[0].X_WM.x = x += way;
      rolled += way;
      EXPECT_NEAR(farm.tick(tick * 100'000'000, states)[0].values[0], rolled, 1e-3) << max_forward << " m/s, " << tick;
    }
    states[0].X_WM.x += 0.51 + 0.2 * max_forward;
    EXPECT_NEAR(farm.tick(3'000'000'000, states)[0].values[0], rolled, 1e-3) << "farther than that is a jump";
  }
}

TEST(Encoder, RelocatedRobotHasNotRolled) {
  const world::World world = one_robot();
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::vector<base::Report> states = robots::states_at_load(world);
  const auto counts = [&](std::int64_t ms, double x) {
    states[0].X_WM.x = x;
    return farm.tick(ms * 1'000'000, states)[0].values[2];
  };
  EXPECT_EQ(counts(0, 100.0), 0.0) << "its first report";
  EXPECT_EQ(counts(100, 100.1), 100.0) << "a step";
  EXPECT_EQ(counts(200, 0.0), 100.0) << "a jump back";
  EXPECT_EQ(counts(300, 0.6), 700.0) << "as far as it can go, and half a metre";
  EXPECT_EQ(counts(10'300, 0.6), 700.0) << "silence";
  EXPECT_EQ(counts(10'400, 10.6), 10'700.0) << "silent for ten seconds, so it may have driven";
}

/// In a simulation, states have the time of the tick. A robot that was at rest or absent was relocated.
TEST(Encoder, RelocatedSimulatedRobotHasNotRolled) {
  for (const bool removed : {false, true}) {
    const world::World world = one_robot();
    farm::Farm farm(world, device());
    farm.subscribe_all();
    std::vector<base::Report> states = robots::states_at_load(world);
    const auto tick = [&](std::int64_t ms, double x) {
      states[0].X_WM.x = x;
      states[0].time = ms * 1'000'000;
      return farm.tick(states[0].time, states);
    };
    tick(0, 0.0);
    EXPECT_EQ(tick(100, 0.1)[0].values[2], 100.0);
    if (removed) farm.set_absent(0, true);
    tick(10'000, 0.1);
    tick(20'000, 0.1);
    if (removed) farm.set_absent(0, false), farm.subscribe_all();
    EXPECT_EQ(tick(20'100, 5.0)[0].values[2], 100.0) << removed;
    EXPECT_EQ(tick(20'200, 5.1)[0].values[2], 200.0) << "it continues from there";
  }
}

/// Readings without subscribers do not stop the count.
TEST(Encoder, CountsWithoutSubscribers) {
  const world::World world = one_robot();
  farm::Farm farm(world, device());
  std::vector<base::Report> states = robots::states_at_load(world);
  for (int tick = 0; tick < 10; ++tick) {
    if (tick == 9) farm.subscribe_all();
    states[0].X_WM.x += 0.01;
    const auto readings = farm.tick(tick * 100'000'000ll, states);
    ASSERT_EQ(readings.size(), tick == 9 ? 1u : 0u);
    EXPECT_TRUE(tick < 9 || readings[0].values[2] == 100.0);
  }
}

TEST(Encoder, RejectsInvalidSettings) {
  expect_refused("encoder", {setting("per_count", {0})}, 8, "'per_count' is 0");
  expect_refused("encoder", {setting("slip", {-0.1})}, 8, "'slip' is -0.1");
  expect_refused("encoder", {setting("scale", {1})}, 8, "expects [left right]");
  expect_refused("encoder", {setting("slip", {0}), setting("scale", {1, 0})}, 9, "factors from 0.1 to 10");
  expect_refused("encoder", {setting("track", {0})}, 8, "'track' is 0");
  expect_refused("encoder", {setting("scrub", {0})}, 8, "'scrub' is 0");
}

}  // namespace
}  // namespace sf::trial
