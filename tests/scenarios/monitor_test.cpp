// The experiment `monitor`: cars that drive by their estimates with faulty sensors, with and without the monitor.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "scenarios/monitor_runs.h"
#include "scenarios/simulation.h"
#include "tests/refusal.h"

namespace sf::scenarios {
namespace {

Scenario monitored_scenario(const std::string& settings) {
  return parse_scenario(
      SF_SOURCE_DIR "/experiments/monitored.toml",
      "world = \"../worlds/simville/simville.world\"\n[default]\ncontroller = \"route\"\nsettings = { " + settings +
          " }\n[[robot]]\nname = \"khepera6\"\ncontroller = \"none\"\n[[robot]]\nname = \"khepera7\"\ncontroller = "
          "\"none\"\n");
}

std::optional<std::size_t> case_of(estimation::MonitoredInput input, base::FaultKind kind) {
  for (std::size_t k = 0; k < monitor_cases().size(); ++k)
    if (monitor_cases()[k].input == input && monitor_cases()[k].kind == kind) return k;
  return std::nullopt;
}

TEST(MonitorExperiment, DrivesWithoutTheFaultySensor) {
  using enum estimation::MonitoredInput;
  using base::FaultKind;
  gpu::Device device;
  const ExperimentOptions options{.threads = 1};
  const Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/monitor.toml");
  const ExperimentContext context{*find_experiment("monitor"), scenario, options, device, {}};
  ASSERT_EQ(monitored_cars(context), 6u);
  const std::vector<std::optional<std::size_t>> faults{std::nullopt,
                                                       case_of(gyro, FaultKind::stuck),
                                                       case_of(encoder, FaultKind::swap),
                                                       case_of(gps, FaultKind::stuck),
                                                       case_of(encoder, FaultKind::dropout),
                                                       case_of(gyro, FaultKind::spikes)};
  const std::vector<MonitoredCar> with = run_monitored(context, 1, true, faults);
  const std::vector<MonitoredCar> without = run_monitored(context, 1, false, faults);
  for (std::size_t k = 0; k < faults.size(); ++k) {
    SCOPED_TRACE(with[k].name);
    EXPECT_EQ(with[k].alarms, 0);
    EXPECT_EQ(with[k].correct, faults[k].has_value());
    EXPECT_TRUE(std::isnan(without[k].detected)) << "it has no monitor";
    EXPECT_LT(with[k].error_squares, 0.1 * static_cast<double>(with[k].steps)) << "0.3 m";
  }
  EXPECT_NEAR(with[0].healthy, kMonitorEnd, 0.2);
  EXPECT_NEAR(with[1].healthy, kFaultFrom, 0.2);
  const auto errors = [](const std::vector<MonitoredCar>& cars) {
    return std::accumulate(cars.begin(), cars.end(), 0.0,
                           [](double sum, const MonitoredCar& car) { return sum + car.error_squares; });
  };
  EXPECT_LT(2.0 * errors(with), errors(without));
}

TEST(MonitorSetting, IsForRobotsThatLocalizeThemselves) {
  gpu::Device device;
  const auto refusal = [&](const std::string& settings) {
    return refusal_of([&] {
      const Scenario scenario = monitored_scenario(settings);
      const world::World world = world_of(scenario);
      Simulation simulation(world, device, simulation_of(scenario, world));
    });
  };
  EXPECT_EQ(refusal("tour = true, monitor = true"), "");
  expect_in("'monitor' is for robots that localize themselves",
            refusal("tour = true, localize = false, monitor = true"));
}

}  // namespace
}  // namespace sf::scenarios
