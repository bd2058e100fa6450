// Derived sensors: wiring, order of inputs, demand, levels, latency, failures.

#include "sensors/derived/derived_sensors.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <map>

#include "base/random.h"
#include "farm/farm.h"
#include "robots/fleet.h"
#include "sensors/derived/own_derived.h"
#include "sensors/encoder.h"
#include "sensors/gyro.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/units.h"
#include "world/append_robot.h"
#include "world/stage/build_world.h"

namespace sf::sensors {
namespace {

constexpr std::uint8_t kTally = 13, kTimer = 14;

/// Chains its inputs: each result depends on all of them and on their order.
struct Tally : sensorfarm::DerivedSensor {
  explicit Tally(const sensorfarm::DerivedSite& site) : inputs(site.inputs.size()), start(site.start) {}
  void take(std::uint32_t input, const sensorfarm::Reading& reading) override {
    if (std::isfinite(reading.X_WS.x)) throw std::runtime_error("it knows a pose");
    chain = 0.5 * chain + reading.values[0] + input;
    ++count;
    newest = reading.time;
  }
  void read(double, sensorfarm::DerivedReading out) override {
    out.values[0] = chain, out.values[1] = count, out.values[2] = newest, out.values[3] = static_cast<double>(inputs);
    if (count == 13) throw std::runtime_error("thirteen");
    out.covariance[0] = 0.25;
    out.valid[0] = count > 0;
  }
  void add_input(const sensorfarm::DerivedInput&) override { ++inputs; }
  double chain = 0.0, count = 0.0, newest = -1.0;
  std::size_t inputs;
  sensorfarm::Pose start;
};

/// The world's readings of one tick, by type.
void add_tally() {
  static bool added = false;
  if (std::exchange(added, true)) return;
  add_own_derived({.name = "tally",
                   .id = kTally,
                   .columns = {{"chain", 1e-6}, {"count", 1.0}, {"newest_s", 1e-3}, {"inputs", 1.0}},
                   .ports = {{"any", {}, 1, 1000}},
                   .rate = 10.0,
                   .covariance = true,
                   .make = [](const sensorfarm::DerivedSite& site,
                              const sensorfarm::SensorSettings&) { return std::make_unique<Tally>(site); }},
                  "test");
  add_own_derived({.name = "timer",
                   .id = kTimer,
                   .columns = {{"chain", 1e-6}},
                   .ports = {{"turn", {"rate_rad_s"}}, {"wheels", {"left_m", "right_m"}}},
                   .make = [](const sensorfarm::DerivedSite&, const sensorfarm::SensorSettings&)
                       -> std::unique_ptr<sensorfarm::DerivedSensor> { throw std::runtime_error("not this one"); }},
                  "test");
}

world::World robot_of(const std::string& derived) {
  add_tally();
  return world::build_world("derived.world",
                            "define bot position( size [0.3 0.3 0.1] drive \"diff\" encoder( rate 20 slip 0.01 )\n"
                            "gyro( rate 10 noise 1 bias 1 latency 0.15 ) )\nbot( name \"r0\" pose [0 0 0 0]\n" +
                                derived + " )\nbot( name \"r1\" pose [3 0 0 0] )\n",
                            {.sensors = world_file_words()});
}

std::string refusal(const std::string& derived) {
  return refusal_of([&] { const SensorSet all(robot_of(derived)); });
}

TEST(Derived, WiringIsCheckedWhenTheWorldIsLoaded) {
  const auto inputs = [](const std::string& list) { return "derived( type \"tally\" inputs " + list + " )"; };
  EXPECT_EQ(refusal(inputs("[\"encoder\" \"r1/gyro\" \"*/encoder\" \"any=gyro:0\"]")), "");
  expect_in("derived.world:4: tally 'derived:0' of 'r0': no robot of this world has a sensor of type 'gyr'",
            refusal(inputs("[\"gyr\"]")));
  expect_in("did you mean 'gyro'?", refusal(inputs("[\"gyr\"]")));
  expect_in("no robot is called 'r2'", refusal(inputs("[\"r2/gyro\"]")));
  expect_in("there is no sensor 'gyro:1'", refusal(inputs("[\"gyro:1\"]")));
  expect_in("'gyro:x' is not an input", refusal(inputs("[\"gyro:x\"]")));
  expect_in("there is no port 'speed'; expected one of", refusal(inputs("[\"speed=gyro\"]")));
  expect_in("'r0/gyro' is listed twice", refusal(inputs("[\"gyro\" \"r0/gyro\"]")));
  expect_in("expected inputs [\"type\" ...]", refusal("derived( type \"tally\" inputs 3 )"));
  expect_in("expected inputs [\"type\" ...]", refusal("derived( type \"tally\" )") + refusal(inputs("[ ]")));
  expect_in(
      "derived sensor type 'taly' is unknown; expected one of: tally, timer, localization, sideslip, model, monitor, "
      "link-speed, features, tracks, location, aggregate; did you mean 'tally'?",
      refusal("derived( type \"taly\" inputs [\"gyro\"] )"));
}

/// Columns name their units, so a port accepts what has its quantities in its units.
TEST(Derived, PortsAcceptColumnsOfTheirUnits) {
  const auto inputs = [](const std::string& list) { return "derived( type \"timer\" inputs " + list + " )"; };
  expect_in("not this one", refusal(inputs("[\"gyro\"]")));
  expect_in("encoder has left_m, right_m, left_counts, right_counts; expected turn (rate_rad_s)",
            refusal(inputs("[\"turn=encoder\"]")));
  expect_in("it has 2 inputs 'turn'; expected 0 to 1", refusal(inputs("[\"gyro\" \"r1/gyro\"]")));
}

TEST(Derived, CyclesAreRefusedWithTheirPath) {
  const std::string circle = refusal(
      "derived( name \"a\" type \"tally\" inputs [\"tally:1\"] ) derived( name \"b\" type \"tally\" inputs "
      "[\"tally:0\"] )");
  expect_in("it is an input of itself: tally 'a' of 'r0' -> tally 'b' of 'r0' -> tally 'a' of 'r0'", circle);
  std::string chain;
  for (int k = 0; k < 70; ++k)
    chain += "derived( type \"tally\" inputs [\"" + (k < 69 ? "tally:" + std::to_string(k + 1) : "gyro") + "\"] )\n";
  expect_in("more than 64 derived sensors depend on each other", refusal(chain));
}

/// The readings of ten ticks of 0.1 s in which the robots turn, as (time, mover, type, number) and values.
using Kept = std::map<std::tuple<std::int64_t, std::uint32_t, int, std::uint32_t>, std::vector<double>>;
Kept ten_ticks(const world::World& world, base::SensorTypes types, unsigned threads = 1,
               farm::FarmStats* stats = nullptr) {
  farm::Farm farm(world, host_device(), {.seed = 3, .threads = threads});
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) farm.subscribe(m, types);
  Kept kept;
  std::vector<base::Report> reports = robots::states_at_load(world);
  for (int tick = 0; tick < 10; ++tick) {
    for (const base::ReadingBlock& r : farm.tick(tick * kSecond / 10, reports))
      kept[{r.time, r.mover, r.type, r.sensor}].assign(r.values.begin(), r.values.end());
    for (base::Report& report : reports)
      report.X_WM.x += 0.02, report.X_WM.yaw += 0.01, report.velocity = {0.2, 0, 0.1};
  }
  if (stats != nullptr) *stats = farm.stats();
  return kept;
}

TEST(Derived, ReadingsHaveQuantitiesValidityAndCovariance) {
  const Kept kept = ten_ticks(robot_of("derived( type \"tally\" inputs [\"gyro\"] )"), farm::kAllSensorTypes);
  const std::vector<double>& first = kept.at({0, 0, kTally, 0});
  ASSERT_EQ(first.size(), 4u + 1u + 10u);
  EXPECT_TRUE(std::isnan(first[0])) << "an invalid row has no numbers";
  EXPECT_EQ(first[4], 0.0);
  const std::vector<double>& last = kept.at({9 * kSecond / 10, 0, kTally, 0});
  EXPECT_EQ(last[1], 8.0) << "the gyro's readings come 0.15 s late: at the second tick after";
  EXPECT_NEAR(last[2], 0.7, 1e-12) << "with the time of their measurement";
  EXPECT_EQ(last[4], 1.0);
  EXPECT_EQ(last[5], 0.25);
  EXPECT_TRUE(std::isnan(last[6])) << "a covariance that is not stated";
}

TEST(Derived, OnlySubscribedSensorsAndTheirInputsAreComputed) {
  const world::World world = robot_of("derived( type \"tally\" inputs [\"gyro\" \"r1/encoder\"] )");
  const Kept all = ten_ticks(world, farm::kAllSensorTypes), only = ten_ticks(world, base::only(kTally));
  EXPECT_EQ(only.size(), 10u) << "inputs are not delivered to anyone else";
  for (const auto& [key, values] : only)
    EXPECT_TRUE(
        std::ranges::equal(values, all.at(key), [](double a, double b) { return a == b || (a != a && b != b); }));
  farm::Farm farm(world, host_device(), {.threads = 1});
  EXPECT_EQ(farm.next_due(), farm::kNever);
  farm.subscribe(0, base::only(kTally));
  EXPECT_EQ(farm.next_due(), 0);
  farm.tick(0, robots::states_at_load(world));
  EXPECT_EQ(farm.next_due(), kSecond / 20) << "the other robot's encoder";
  farm.subscribe(0, base::only(kGyro));
  EXPECT_EQ(farm.next_due(), kSecond / 10) << "the inputs stop with their only consumer";
}

/// As for all sensors of a robot that is not there.
TEST(Derived, SensorsOfAbsentRobotsAreNoInputs) {
  const world::World world = robot_of("derived( type \"tally\" inputs [\"r1/encoder\"] )");
  farm::Farm farm(world, host_device(), {.threads = 1});
  farm.subscribe_all();
  const auto reports = robots::states_at_load(world);
  const auto count = [&](int tick) {
    for (const base::ReadingBlock& reading : farm.tick(tick * kSecond / 10, reports))
      if (reading.type == kTally) return reading.values[1];
    return -1.0;
  };
  EXPECT_EQ(count(0), 1.0);
  EXPECT_EQ(count(1), 2.0);
  farm.set_absent(1, true);
  EXPECT_EQ(count(2), 2.0);
  EXPECT_EQ(count(3), 2.0);
  farm.set_absent(1, false);
  EXPECT_EQ(count(4), 3.0) << "it is back";
}

TEST(Derived, StartOverWhenSubscribedAgain) {
  const world::World world = robot_of("derived( type \"tally\" inputs [\"encoder\"] )");
  farm::Farm farm(world, host_device(), {.threads = 1});
  const auto reports = robots::states_at_load(world);
  const auto count = [&](int tick) {
    const auto readings = farm.tick(tick * kSecond / 10, reports);
    return readings.empty() ? -1.0 : readings[0].values[1];
  };
  farm.subscribe(0, base::only(kTally));
  EXPECT_EQ(count(0), 1.0);
  EXPECT_EQ(count(1), 2.0);
  farm.subscribe(0, base::SensorTypes{0});
  EXPECT_EQ(count(2), -1.0);
  farm.subscribe(0, base::only(kTally));
  EXPECT_EQ(count(3), 1.0);
}

/// A derived sensor of a derived sensor has its reading in the same tick, one with latency later.
TEST(Derived, LevelsFollowEachOtherWithinATick) {
  const std::string below = "derived( name \"below\" type \"tally\" inputs [\"encoder\"] ";
  const std::string above = "derived( name \"above\" type \"tally\" inputs [\"tally:0\"] )";
  const Kept prompt = ten_ticks(robot_of(below + ")" + above), farm::kAllSensorTypes);
  const Kept late = ten_ticks(robot_of(below + "latency 0.2 )" + above), farm::kAllSensorTypes);
  EXPECT_EQ(prompt.at({9 * kSecond / 10, 0, kTally, 1})[1], 10.0);
  EXPECT_EQ(late.at({9 * kSecond / 10, 0, kTally, 1})[1], 8.0);
  EXPECT_EQ(prompt.at({7 * kSecond / 10, 0, kTally, 0})[0], late.at({7 * kSecond / 10, 0, kTally, 0})[0]);
}

/// Derived sensors take faulty inputs, measured and derived, and have faults of their own.
TEST(Derived, InputsHaveTheirFaults) {
  const world::World world = robot_of(
      "derived( name \"below\" type \"tally\" inputs [\"encoder\"] )\n"
      "derived( name \"above\" type \"tally\" inputs [\"tally:0\"] )");
  const auto last = [&](std::vector<farm::Fault> faults) {
    farm::Farm farm(world, host_device(), {.seed = 3, .threads = 1, .faults = std::move(faults)});
    farm.subscribe_all();
    std::vector<std::vector<double>> values(2);
    for (int tick = 0; tick < 10; ++tick)
      for (const base::ReadingBlock& r : farm.tick(tick * kSecond / 10, robots::states_at_load(world)))
        if (r.type == kTally && r.mover == 0) values[r.sensor].assign(r.values.begin(), r.values.end());
    return values;
  };
  const auto clean = last({});
  const farm::Fault bias{.kind = base::FaultKind::bias, .robot = "r0", .type = "encoder", .amount = 1.0};
  EXPECT_EQ(clean[0][0], 0.0);
  EXPECT_NEAR(last({bias})[0][0], 2.0, 0.01) << "the sum of 1, 1/2, 1/4 and so on";
  farm::Fault lost{.kind = base::FaultKind::dropout, .robot = "r0", .type = "tally", .from = 0.35};
  EXPECT_EQ(clean[1][1], 10.0);
  EXPECT_EQ(last({lost})[1][1], 4.0) << "it has readings until then";
  lost.kind = base::FaultKind::delay, lost.from = 0.0, lost.amount = 0.2;
  EXPECT_EQ(last({lost})[1][1], 8.0);
}

TEST(Derived, ThreadsDoNotChangeAByte) {
  std::string many;
  for (int k = 0; k < 40; ++k) many += "derived( type \"tally\" inputs [\"gyro\" \"*/encoder\" \"*/gyro\"] )\n";
  const world::World world = robot_of(many);
  const auto hash = [&](unsigned threads) {
    farm::Farm farm(world, host_device(), {.seed = 5, .threads = threads});
    farm.subscribe_all();
    for (int tick = 0; tick < 4; ++tick) farm.tick(tick * kSecond / 10, robots::states_at_load(world));
    return farm.hash();
  };
  EXPECT_EQ(hash(1), hash(3));
}

/// Any order of arrival within one call gives the same bytes.
TEST(Derived, OrderOfArrivalDoesNotMatter) {
  const world::World world = robot_of("derived( type \"tally\" inputs [\"gyro\" \"encoder\" \"r1/gyro\"] )");
  const SensorSet all(world);
  base::ThreadPool pool(1);
  const auto states = robots::states_at_load(world);
  EXPECT_TRUE(rc::check([&](std::uint64_t seed) {
    std::vector<std::vector<double>> values;
    std::vector<base::ReadingBlock> delivered;
    for (std::uint32_t k = 0; k < 8; ++k)
      values.push_back({base::random_normal({seed, base::RandomStream::gyro, k}, 0)[0], 0, 0, 0});
    for (std::uint32_t k = 0; k < 8; ++k)
      delivered.push_back({.mover = k % 2,
                           .type = k % 3 == 0 ? kEncoder : kGyro,
                           .sequence = k,
                           .time = static_cast<std::int64_t>(k / 3) * kSecond,
                           .values = values[k]});
    const auto chain = [&] {
      DerivedSensors derived(world, all, pool);
      derived.want(std::vector<base::SensorTypes>(2, farm::kAllSensorTypes));
      const DueSample due[] = {{0, 0}};
      const std::span<const DueSample> dues[] = {due};
      return derived.evaluate(9 * kSecond, delivered, dues, states)[0].values[0];
    };
    const double first = chain();
    for (int shuffle = 0; shuffle < 5; ++shuffle) {
      for (std::size_t k = delivered.size(); k-- > 1;)
        std::swap(delivered[k], delivered[*rc::gen::inRange<std::size_t>(0, k + 1)]);
      RC_ASSERT(chain() == first);
    }
  }));
}

TEST(Derived, RobotsThatJoinBecomeInputs) {
  world::World world = robot_of("derived( type \"tally\" inputs [\"*/encoder\"] )");
  farm::Farm farm(world, host_device(), {.threads = 1});
  farm.subscribe_all();
  auto reports = robots::states_at_load(world);
  const auto tally = [&](int tick) {
    for (const base::ReadingBlock& r : farm.tick(tick * kSecond / 10, reports))
      if (r.type == kTally) return std::pair{r.values[1], r.values[3]};
    return std::pair{-1.0, -1.0};
  };
  EXPECT_EQ(tally(0), (std::pair{2.0, 2.0}));
  world::append_robot(world, 1, "r2", {6, 0, 0, 0});
  const auto before = farm.add_mover();
  reports = robots::states_at_load(world);
  farm.subscribe(2, farm::kAllSensorTypes);
  EXPECT_EQ(tally(1), (std::pair{5.0, 3.0})) << "its count goes on";
}

TEST(Derived, CommandsOfTheLastTickAreInputs) {
  const world::World world = robot_of("derived( type \"tally\" inputs [\"command\" \"r1/command\"] )");
  farm::Farm farm(world, host_device(), {.threads = 1});
  farm.subscribe(0, base::only(kTally));
  const base::Twist commands[] = {{0.5, 0.0, 0.0}, {0.25, 0.0, 0.0}};
  farm.set_commands(commands);
  const auto reports = robots::states_at_load(world);
  EXPECT_EQ(farm.tick(0, reports)[0].values[0], 1.5) << "0.5, then half of it, 0.25 and the number of the input, 1";
  EXPECT_EQ(farm.tick(kSecond / 10, reports)[0].values[1], 2.0) << "none since then";
}

TEST(Derived, AnExceptionEndsTheRunWithItsMessage) {
  const world::World world = robot_of("derived( name \"bad\" type \"tally\" inputs [\"encoder\"] rate 20 )");
  expect_in("tally 'bad' of 'r0' failed at 0.600 s: thirteen", refusal_of([&] {
              farm::Farm farm(world, host_device(), {.threads = 1});
              farm.subscribe_all();
              for (int tick = 0; tick < 20; ++tick) farm.tick(tick * kSecond / 20, robots::states_at_load(world));
            }));
}

TEST(Derived, SharedFleetsRefuseInputsOfOtherRobots) {
  const auto share = [](const world::World& world) {
    return refusal_of([&] { const farm::Farm farm(world, host_device(), {.threads = 1, .shared = true}); });
  };
  EXPECT_EQ(share(robot_of("derived( type \"tally\" inputs [\"encoder\"] )")), "");
  expect_in("which several processes cannot share",
            share(robot_of("derived( type \"tally\" inputs [\"r1/encoder\"] )")));
}

}  // namespace
}  // namespace sf::sensors
