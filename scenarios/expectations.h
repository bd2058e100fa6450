#pragma once
// Expectations of a scenario: their check before the run, their measures and their results. scenarios/scenario_file.cpp
// reads them.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "scenarios/run_metrics.h"
#include "scenarios/scenario.h"

namespace sf::scenarios {

/// An expectation and its measured value.
struct ExpectationResult {
  std::string what;      ///< "mean_abs_error of roomba0"
  std::string expected;  ///< "<= 0.05"
  std::string measured;  ///< "0.0412"
  bool met = false;
  int line = 0;  ///< in the scenario's file
};

/// A measure of a run over all robots: the sum, or the value of the worst robot, as in [expect] (docs/scenarios.md).
struct Metric {
  std::string name;    ///< key of the expectation, or "KEY of ROBOT"
  double value = 0.0;  ///< in the expectation's unit; NaN if there was nothing to measure
};

/// A run that has ended. Its references must outlive it.
struct MeasuredRun {
  const Scenario& scenario;
  const world::World& world;
  const RunMetrics& metrics;
  const std::map<std::uint32_t, double>& coverages;  ///< [-] by row of the mover, of the robots whose map is expected
  const std::vector<double>& tick_ms;                ///< [ms] duration of each tick
  bool all_done = false;                             ///< whether all controllers have finished
};

/// @throws base::InputError if the world or its robots lack something that the expectation needs
void check_expectation(const Scenario& scenario, const world::World& world, const SimulationOptions& options,
                       const Expectation& e);

/// Returns the measured value in the expectation's unit; NaN if there was nothing to measure.
double measure(const MeasuredRun& run, const Expectation& e);

/// Measures an expectation and compares the value with its limit.
ExpectationResult judge(const MeasuredRun& run, const Expectation& e);

/// Returns the metrics of every run, then the other ones that the scenario expects.
std::vector<Metric> metrics_of(const MeasuredRun& run);

}  // namespace sf::scenarios
