// The derived sensor `monitor`: its columns with and without a faulty gyro, and sensors that are refused.

#include "sensors/monitor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/time.h"
#include "farm/farm.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/host_trial.h"
#include "world/stage/build_world.h"

namespace sf::trial {
namespace {

constexpr double kFaultFrom = 20.0, kFaultUntil = 40.0;  // [s]
constexpr double kForward = 0.3, kTurn = 0.2;            // [m/s], [rad/s]

world::World monitored(const std::string& derived) {
  return world::build_world(
      "monitored.world",
      "define bot position( size [0.3 0.3 0.1] drive \"diff\" encoder( per_count 0.001 slip 0.005 )\n"
      "gyro( bias 0.5 noise 0.1 ) gps( noise 0.2 latency 0.1 )\n" +
          derived + " )\nbot( name \"r0\" pose [1 2 0 30] )\n",
      {.sensors = sensors::world_file_words()});
}

/// Drives circles. Returns the readings at `times` [s], ascending.
std::vector<std::vector<double>> readings_at(const world::World& world, const std::vector<farm::Fault>& faults,
                                             const std::vector<double>& times, base::Pose* truth = nullptr) {
  farm::Farm farm(world, host_device(), {.seed = 1, .threads = 1, .faults = faults});
  farm.subscribe(0, base::only(sensors::kMonitor));
  std::vector<std::vector<double>> all;
  base::Pose X_WM = world.movers[0].X_WM;
  constexpr double kStep = 0.1;
  for (int tick = 0; all.size() < times.size(); ++tick) {
    const base::Report report{0, 0, X_WM, {kForward, 0.0, kTurn}};
    for (const base::ReadingBlock& block : farm.tick(base::nanoseconds(tick * kStep), {&report, 1}))
      if (block.type == sensors::kMonitor && tick * kStep > times[all.size()] - 1e-9) {
        all.emplace_back(block.values.begin(), block.values.end());
        if (truth != nullptr) *truth = X_WM;
        break;
      }
    X_WM = {X_WM.x + kForward * kStep * std::cos(X_WM.yaw + 0.5 * kTurn * kStep),
            X_WM.y + kForward * kStep * std::sin(X_WM.yaw + 0.5 * kTurn * kStep), X_WM.z, X_WM.yaw + kTurn * kStep};
  }
  return all;
}

const std::string kAll = "derived( type \"monitor\" inputs [\"encoder\" \"gyro\" \"gps\"] rate 10 )";

TEST(Monitor, ReplacesAFaultyGyroAndHandsBack) {
  const farm::Fault bias{.kind = base::FaultKind::bias,
                         .robot = "r0",
                         .type = "gyro",
                         .amount = 0.5,
                         .from = kFaultFrom,
                         .until = kFaultUntil};
  base::Pose truth;
  const auto readings = readings_at(monitored(kAll), {bias}, {kFaultFrom - 0.5, kFaultUntil - 1.0, 75.0}, &truth);
  for (const std::vector<double>& reading : readings) {
    ASSERT_EQ(reading.size(), 18u);
    EXPECT_EQ(reading[3], 1.0) << "valid";
    EXPECT_NEAR(reading[sensors::kMonitorSpeedAt], kForward, 0.1);
    EXPECT_NEAR(reading[sensors::kMonitorSpeedAt + 1], kTurn, 0.2) << "not the faulty rate";
    EXPECT_EQ(reading[sensors::kMonitorStatesAt], 0.0) << "encoder";
    EXPECT_EQ(reading[sensors::kMonitorStatesAt + 2], 0.0) << "gps";
  }
  const std::size_t state = sensors::kMonitorStatesAt + 1, residual = sensors::kMonitorResidualsAt + 1;
  EXPECT_EQ(readings[0][state], 0.0);
  EXPECT_LT(readings[0][residual], 1.0);
  EXPECT_EQ(readings[1][state], 1.0);
  EXPECT_GT(readings[1][residual], 1.0);
  EXPECT_EQ(readings[2][state], 0.0);
  EXPECT_NEAR(readings[2][0], truth.x, 0.5);
  EXPECT_NEAR(readings[2][1], truth.y, 0.5);
}

TEST(Monitor, StatesInputsThatAreAbsent) {
  const farm::Fault lost{.kind = base::FaultKind::dropout, .robot = "r0", .type = "encoder", .from = kFaultFrom};
  const auto readings = readings_at(monitored(kAll), {lost}, {kFaultFrom - 0.5, kFaultFrom + 5.0});
  EXPECT_EQ(readings[0][sensors::kMonitorStatesAt], 0.0);
  EXPECT_EQ(readings[1][sensors::kMonitorStatesAt], 2.0);
  const auto two =
      readings_at(monitored("derived( type \"monitor\" inputs [\"encoder\" \"gps\"] rate 10 )"), {}, {10.0});
  EXPECT_EQ(two[0][sensors::kMonitorStatesAt + 1], 2.0) << "it has no gyro";
}

TEST(Monitor, RefusesWhatItCannotCompare) {
  const auto refusal = [](const std::string& more) {
    return refusal_of([&] { const sensors::SensorSet all(monitored("derived( type \"monitor\" " + more + " )")); });
  };
  EXPECT_EQ(refusal("inputs [\"encoder\" \"gps\"]"), "");
  expect_in("needs two or three", refusal("inputs [\"encoder\"]"));
  expect_in("'thresholds' expects", refusal("inputs [\"encoder\" \"gps\"] thresholds [1 2 3 4 5 6 7 8 0]"));
  expect_in("hold", refusal("inputs [\"encoder\" \"gps\"] hold -1"));
}

}  // namespace
}  // namespace sf::trial
