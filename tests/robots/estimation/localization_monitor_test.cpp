#include "robots/estimation/localization_monitor.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/robots/estimation/driven_robot.h"

namespace sf::estimation {
namespace {

using reference::DrivenRobot;
using enum MonitoredInput;

constexpr std::int64_t kStep = 100'000'000;  // [ns]
constexpr double kOnset = 60.0;              // [s]
constexpr double kGpsNoise = 0.2;            // [m]

/// Readings of one step; NaN: none.
struct Readings {
  double left, right, rate, x, y;
  double time;  ///< [s]
};
using Corrupt = std::function<void(Readings&)>;

const LocalizationOptions kOptions{
    .encoder = LocalizationOptions::Encoder{}, .gyro = {1.7e-3, 8.7e-3}, .gps_noise = kGpsNoise};

/// Drives a robot past a fault that ends after 30 s, with a monitor and, for comparison, a filter.
struct MonitoredDrive {
  explicit MonitoredDrive(std::uint64_t seed) { robot.random.seed(seed), robot.gyro_bias = robot.normal(8.7e-3); }

  void run(double until, const Corrupt& corrupt) {
    for (; robot.time < static_cast<std::int64_t>(1e9 * until); ++steps) {
      const double turn = std::array{0.0, 0.4, 0.0, -0.3, 0.1}[robot.time / 4'000'000'000 % 5];
      robot.drive({0.2, 0.0, turn}, kStep);
      const bool fix = steps % 10 == 0;
      const auto coordinate = [&](double v) { return fix ? v + robot.normal(kGpsNoise / std::sqrt(2.0)) : NAN; };
      Readings r{.left = robot.counted(robot.left),
                 .right = robot.counted(robot.right),
                 .rate = robot.velocity.turn + robot.gyro_bias + robot.normal(1.7e-3),
                 .x = coordinate(robot.X_WM.x),
                 .y = coordinate(robot.X_WM.y),
                 .time = 1e-9 * static_cast<double>(robot.time)};
      if (r.time > kOnset && r.time < kOnset + 30.0) corrupt(r);
      take(r);
    }
  }

  void take(const Readings& r) {
    const auto add = [&](auto& to) {
      const bool gyro_first = robot.random() % 2 == 0;  // any order of one time
      if (gyro_first && std::isfinite(r.rate)) to.add_gyro(robot.time, r.rate);
      if (std::isfinite(r.left)) to.add_encoder(robot.time, r.left, r.right);
      if (!gyro_first && std::isfinite(r.rate)) to.add_gyro(robot.time, r.rate);
      if (std::isfinite(r.x)) to.add_gps(robot.time, r.x, r.y, 1.0);
    };
    add(monitor), add(filter);
    monitor.update(robot.time);
    const auto error = [&](const auto& of) {
      const base::Pose X = of.predict(robot.time).estimate.X_WM;
      return std::hypot(X.x - robot.X_WM.x, X.y - robot.X_WM.y);
    };
    if (r.time > kOnset && r.time < kOnset + 30.0) monitored += error(monitor), filtered += error(filter);
    for (const MonitoredInput input : {encoder, gyro, gps}) {
      const InputState now = monitor.state(input);
      auto& before = states[static_cast<std::size_t>(input)];
      if (now != before) changes.push_back({input, now, r.time});
      before = now;
    }
  }

  /// Returns the first time at which an input was in that state; NaN: never.
  double first(MonitoredInput input, InputState state) const {
    for (const Change& each : changes)
      if (each.input == input && each.state == state) return each.time;
    return NAN;
  }

  std::string text() const {
    std::string all;
    for (const Change& each : changes)
      all += fmt::format(" {}:{} at {:.1f}", static_cast<int>(each.input), static_cast<int>(each.state), each.time);
    return all + fmt::format(", errors {:.2f} {:.2f}", monitored, filtered);
  }

  struct Change {
    MonitoredInput input;
    InputState state;
    double time;
  };
  DrivenRobot robot;
  LocalizationMonitor monitor = started(LocalizationMonitor(kOptions, {}, true, true));
  Localization filter = started(Localization(kOptions));
  std::int64_t steps = 0;
  double monitored = 0.0, filtered = 0.0;  ///< [m] sums of position errors during the fault
  std::array<InputState, 3> states{};
  std::vector<Change> changes;

 private:
  template <class Filter>
  static Filter started(Filter filter) {
    filter.add_pose(0, {}, kKnownStart);
    return filter;
  }
};

TEST(LocalizationMonitor, IsTheFilterWithoutFaults) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    MonitoredDrive drive(seed);
    drive.run(120.0, [](Readings&) {});
    EXPECT_TRUE(drive.changes.empty()) << "seed " << seed << " at " << drive.changes[0].time;
    EXPECT_EQ(drive.monitored, drive.filtered);
  }
}

struct FaultCase {
  std::string name;
  MonitoredInput input;
  Corrupt corrupt;
  double within;  ///< [s] until it is isolated
};

class LocalizationMonitorFault : public testing::TestWithParam<FaultCase> {};

TEST_P(LocalizationMonitorFault, IsIsolatedSubstitutedAndHandedBack) {
  const FaultCase& fault = GetParam();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    MonitoredDrive drive(seed);
    drive.run(kOnset + 29.9, fault.corrupt);
    SCOPED_TRACE(fmt::format("seed {}: input:state{}", seed, drive.text()));
    const double isolated = drive.first(fault.input, InputState::faulty);
    EXPECT_GT(isolated, kOnset);
    EXPECT_LT(isolated, kOnset + fault.within);
    for (const MonitoredInput other : {encoder, gyro, gps})
      EXPECT_TRUE(other == fault.input || std::isnan(drive.first(other, InputState::faulty)));
    // The filter's own gates reject some faults; then both are as good: 0.35 m.
    EXPECT_LT(drive.monitored, std::max(105.0, 0.5 * drive.filtered));
    drive.run(240.0, fault.corrupt);
    EXPECT_EQ(drive.monitor.state(fault.input), InputState::good);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, LocalizationMonitorFault,
    testing::Values(FaultCase{"GyroBias", gyro, [](Readings& r) { r.rate += 0.2; }, 15.0},
                    FaultCase{"GyroStuck", gyro, [](Readings& r) { r.rate = 0.1; }, 1.0},
                    FaultCase{"EncoderScale", encoder, [](Readings& r) { r.left *= 1.3; }, 15.0},
                    FaultCase{"EncoderSwapped", encoder, [](Readings& r) { std::swap(r.left, r.right); }, 15.0},
                    FaultCase{"EncoderStuck", encoder, [](Readings& r) { r.left = r.right = 12.0; }, 15.0},
                    FaultCase{"GpsBias", gps, [](Readings& r) { r.x += 4.0; }, 15.0},
                    FaultCase{"GpsDrift", gps, [](Readings& r) { r.y += 0.3 * (r.time - kOnset); }, 25.0}),
    [](const testing::TestParamInfo<FaultCase>& each) { return each.param.name; });

TEST(LocalizationMonitor, ReportsAnAbsentInputAndWaitsForIt) {
  MonitoredDrive drive(1);
  drive.run(120.0, [](Readings& r) { r.left = r.right = NAN; });
  EXPECT_NEAR(drive.first(encoder, InputState::absent), kOnset + 0.4, 0.15);
  EXPECT_TRUE(std::isnan(drive.first(encoder, InputState::faulty)));
  EXPECT_NEAR(drive.changes.back().time, kOnset + 30.0, 0.2);
  EXPECT_EQ(drive.monitor.state(encoder), InputState::good);
}

/// Absurd readings are faults as well, and their statistics are forgotten.
TEST(LocalizationMonitor, RecoversFromAbsurdReadings) {
  for (const double value : {1e9, -1e300, HUGE_VAL, 0.0}) {
    MonitoredDrive drive(1);
    drive.run(300.0, [&](Readings& r) {
      if (r.time < kOnset + 1.0) r.rate = r.left = r.x = value;
    });
    for (const MonitoredInput input : {encoder, gyro, gps}) {
      EXPECT_EQ(drive.monitor.state(input), InputState::good) << value;
      EXPECT_LT(drive.monitor.residual(input), 1.0) << value;
    }
  }
}

}  // namespace
}  // namespace sf::estimation
