#include "scenarios/expectations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "scenarios/statistics.h"
#include "sensors/laser_settings.h"

namespace sf::scenarios {

namespace {

using Kind = Expectation::Kind;

/// Returns the rows of the robots to which an expectation applies.
std::vector<std::uint32_t> rows_of(const Scenario& scenario, const world::World& world, const Expectation& e) {
  if (!e.robot.empty()) return {row_of(scenario, world, e.robot, e.line)};
  std::vector<std::uint32_t> rows;
  for (std::uint32_t i = 0; i < world.movers.size(); ++i)
    if (!world.movers[i].is_tag) rows.push_back(i);
  return rows;
}

std::string what_of(const Expectation& e) {
  return std::string(expectation_kind_name(e.kind)) + (e.robot.empty() ? "" : " of " + e.robot);
}

/// Returns the worst value of a measure over the expectation's robots, ignoring NaN; NaN without a value.
template <class Measure>
double worst(const MeasuredRun& run, const Expectation& e, bool least, Measure&& measure_row) {
  double value = std::nan("");
  for (const std::uint32_t row : rows_of(run.scenario, run.world, e)) {
    const double v = measure_row(row);
    if (std::isnan(v)) continue;
    value = std::isnan(value) ? v : least ? std::min(value, v) : std::max(value, v);
  }
  return value;
}

/// Returns the measured value as text, with words for missing values.
std::string text_of_measured(const Expectation& e, double value) {
  if (!std::isnan(value)) {
    // Truncated, so that only complete coverage is shown as 1.
    if (e.kind == Kind::map_coverage) return fmt::format("{:g}", std::floor(1e5 * value) / 1e5);
    return fmt::format("{:.4g}", value);
  }
  if (e.kind == Kind::mean_error || e.kind == Kind::mean_abs_error)
    return e.robot.empty() ? "no robot with a control error" : "no control error";
  if (e.kind == Kind::checkpoints) return "no robot with checkpoints";
  return "nothing to measure";
}

}  // namespace

void check_expectation(const Scenario& scenario, const world::World& world, const SimulationOptions& options,
                       const Expectation& e) {
  const auto refuse = [&](const std::string& message) { throw base::InputError(scenario.file, e.line, message); };
  const auto rows = rows_of(scenario, world, e);
  const bool of_driven = e.kind == Kind::checkpoints || e.kind == Kind::mean_error || e.kind == Kind::mean_abs_error;
  if (of_driven && std::all_of(rows.begin(), rows.end(),
                               [&](std::uint32_t row) { return options.actors[row].controller.name.empty(); }))
    refuse(fmt::format("'{}' of a robot without a controller; give the robot one", expectation_kind_name(e.kind)));
  if (e.kind == Kind::map_coverage &&
      std::all_of(rows.begin(), rows.end(), [&](std::uint32_t row) { return !sensors::has_laser(world.movers[row]); }))
    refuse(e.robot.empty() ? "no robot has a laser to build a map with; give one a laser"
                           : fmt::format("'{}' has no laser to build a map with; give it one", e.robot));
  if (e.kind == Kind::lights_obeyed && world.lights.empty())
    refuse(world.file + " has no traffic lights; leave this out");
}

double measure(const MeasuredRun& run, const Expectation& e) {
  switch (e.kind) {
    case Kind::no_collision:
    case Kind::contacts:
      // Summed over all robots unless a robot is named. Other values are those of the worst robot.
      if (e.robot.empty()) return static_cast<double>(run.metrics.contacts());
      return worst(run, e, false, [&](std::uint32_t r) { return static_cast<double>(run.metrics.of(r).contacts); });
    case Kind::mean_error:
      return worst(run, e, false,
                   [&](std::uint32_t r) { return std::abs(statistics_of(run.metrics.of(r).errors).mean); });
    case Kind::mean_abs_error:
      return worst(run, e, false, [&](std::uint32_t r) { return statistics_of(run.metrics.of(r).errors).abs_mean; });
    case Kind::map_coverage:
      return worst(run, e, true,
                   [&](std::uint32_t r) { return run.coverages.contains(r) ? run.coverages.at(r) : std::nan(""); });
    case Kind::lights_obeyed:
      return static_cast<double>(run.metrics.red_lights_passed());
    case Kind::done:
      return run.all_done ? 1.0 : 0.0;
    case Kind::distance:
      return worst(run, e, true, [&](std::uint32_t r) { return run.metrics.of(r).travelled; });
    case Kind::checkpoints:
      return worst(run, e, true, [&](std::uint32_t r) {
        return run.metrics.of(r).goals.any ? static_cast<double>(run.metrics.of(r).goals.passed) : std::nan("");
      });
    case Kind::all_checkpoints:
      return static_cast<double>(run.metrics.checkpoints());
    case Kind::tick_p99:
      return percentile(run.tick_ms, 0.99);
  }
  return std::nan("");
}

ExpectationResult judge(const MeasuredRun& run, const Expectation& e) {
  const double value = measure(run, e);
  ExpectationResult outcome{.what = what_of(e), .measured = text_of_measured(e, value), .line = e.line};
  switch (e.kind) {
    case Kind::no_collision:
    case Kind::lights_obeyed:
      outcome.expected = e.kind == Kind::no_collision ? "no contact" : "no red passed";
      outcome.met = value == 0.0;
      return outcome;
    case Kind::done:
      outcome.expected = "done";
      outcome.measured = value == 1.0 ? "done" : "not done";
      outcome.met = value == 1.0;
      return outcome;
    case Kind::map_coverage:
    case Kind::distance:
    case Kind::checkpoints:
    case Kind::all_checkpoints:
      outcome.expected = fmt::format(">= {:g}", e.limit);
      outcome.met = value >= e.limit;
      return outcome;
    default:
      outcome.expected = fmt::format("<= {:g}", e.limit);
      outcome.met = value <= e.limit;
      return outcome;
  }
}

/// `no_collision` duplicates `contacts`. `map_coverage` needs a map, so it is computed only if expected.
std::vector<Metric> metrics_of(const MeasuredRun& run) {
  std::vector<Expectation> all;
  for (const Kind kind : {Kind::contacts, Kind::mean_error, Kind::mean_abs_error, Kind::distance, Kind::checkpoints,
                          Kind::all_checkpoints, Kind::lights_obeyed, Kind::done})
    all.push_back({.kind = kind});
  for (const Expectation& e : run.scenario.expect) {
    const bool there = std::any_of(all.begin(), all.end(), [&](const Expectation& other) {
      return other.kind == e.kind && other.robot == e.robot;
    });
    if (!there && e.kind != Kind::no_collision && e.kind != Kind::tick_p99) all.push_back(e);
  }
  std::vector<Metric> metrics;
  for (const Expectation& e : all) {
    const bool lights = e.kind == Kind::lights_obeyed;
    metrics.push_back({lights ? "red_lights_passed" : what_of(e),
                       lights && run.world.lights.empty() ? std::nan("") : measure(run, e)});
  }
  return metrics;
}

}  // namespace sf::scenarios
