#include "scenarios/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "base/error.h"
#include "scenarios/coverage.h"
#include "scenarios/statistics.h"
#include "scenarios/watch.h"

namespace sf::scenarios {

namespace {

using Kind = Expectation::Kind;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

bool expects(const Scenario& scenario, Kind kind) {
  return std::any_of(scenario.expect.begin(), scenario.expect.end(),
                     [&](const Expectation& e) { return e.kind == kind; });
}

/// One run with all that is counted of it.
class Run {
 public:
  Run(const Scenario& scenario, gpu::Device& device)
      : scenario_(scenario),
        world_(world_of(scenario)),
        simulation_(world_, device, simulation_of(scenario, world_)),
        watch_(world_, simulation_) {
    for (const Expectation& e : scenario.expect) {
      const auto rows = rows_of(e);
      if (e.kind == Kind::map_coverage) add_maps(e, rows);
      if (e.kind == Kind::checkpoints || e.kind == Kind::mean_error || e.kind == Kind::mean_abs_error)
        require_driven(e, rows);
      if (e.kind == Kind::lights_obeyed && world_.lights.empty())
        throw base::InputError(scenario.file, e.line, world_.file + " has no lights to be obeyed; leave this out");
    }
  }

  void go(const std::function<void(double)>& progress, ScenarioResult& result) {
    const auto ticks = static_cast<std::uint64_t>(std::llround(scenario_.duration / world_.interval));
    const bool until_done = expects(scenario_, Kind::done);
    const auto start = Clock::now();
    for (; result.ticks < ticks && !(until_done && simulation_.all_done()); ++result.ticks) {
      const auto begin = Clock::now();
      const base::TickRecord tick = simulation_.step();
      tick_ms_.push_back(1e3 * seconds_since(begin));
      watch_.look(tick);
      for (auto& [row, map] : maps_)
        for (const base::ReadingBlock& reading : tick.readings) map.add(reading);
      if (progress && result.ticks % 16 == 0) progress(static_cast<double>(result.ticks) / static_cast<double>(ticks));
    }
    result.wall = seconds_since(start);
    result.simulated = static_cast<double>(result.ticks) * world_.interval;
    result.hash = simulation_.farm().hash();
    for (const Expectation& e : scenario_.expect) result.outcomes.push_back(judge(e));
  }

 private:
  /// The robots that an expectation is about.
  std::vector<std::uint32_t> rows_of(const Expectation& e) const {
    if (!e.robot.empty()) return {row_of(scenario_, world_, e.robot, e.line)};
    std::vector<std::uint32_t> rows;
    for (std::uint32_t i = 0; i < world_.movers.size(); ++i)
      if (!world_.movers[i].is_tag) rows.push_back(i);
    return rows;
  }

  void require_driven(const Expectation& e, const std::vector<std::uint32_t>& rows) const {
    if (std::any_of(rows.begin(), rows.end(),
                    [&](std::uint32_t row) { return simulation_.controller(row) != nullptr; }))
      return;
    throw base::InputError(scenario_.file, e.line,
                           fmt::format("'{}' of a robot that nobody drives; give it a controller", name_of(e.kind)));
  }

  void add_maps(const Expectation& e, const std::vector<std::uint32_t>& rows) {
    for (const std::uint32_t row : rows) {
      if (world_.movers[row].lasers.empty() && !e.robot.empty())
        throw base::InputError(scenario_.file, e.line,
                               fmt::format("'{}' has no laser to make a map with; give it one", e.robot));
      if (!world_.movers[row].lasers.empty()) maps_.try_emplace(row, world_, row);
    }
  }

  /// The worst of some robots by a measure; not a number where none has one.
  template <class Measure>
  double worst(const Expectation& e, bool least, Measure&& measure) const {
    double value = std::nan("");
    for (const std::uint32_t row : rows_of(e)) {
      const double v = measure(row);
      if (std::isnan(v)) continue;
      value = std::isnan(value) ? v : least ? std::min(value, v) : std::max(value, v);
    }
    return value;
  }

  double measure(const Expectation& e) const {
    switch (e.kind) {
      case Kind::no_collision:
      case Kind::contacts:
        return worst(e, false, [&](std::uint32_t r) { return static_cast<double>(watch_.of(r).contacts); });
      case Kind::mean_error:
        return worst(e, false, [&](std::uint32_t r) { return std::abs(statistics_of(watch_.of(r).errors).mean); });
      case Kind::mean_abs_error:
        return worst(e, false, [&](std::uint32_t r) { return statistics_of(watch_.of(r).errors).abs_mean; });
      case Kind::map_coverage:
        return worst(e, true, [&](std::uint32_t r) {
          const auto map = maps_.find(r);
          if (map == maps_.end()) return std::nan("");
          const maps::Grid& grid = map->second.grid();
          return coverage(grid, what_could_be_seen(world_, r, grid.plan));
        });
      case Kind::lights_obeyed:
        return static_cast<double>(watch_.reds());
      case Kind::done:
        return simulation_.all_done() ? 1.0 : 0.0;
      case Kind::checkpoints:
        return worst(e, true, [&](std::uint32_t r) {
          return watch_.of(r).has_goals ? static_cast<double>(watch_.of(r).checkpoints) : std::nan("");
        });
      case Kind::all_checkpoints:
        return static_cast<double>(watch_.checkpoints());
      case Kind::tick_p99:
        return percentile(tick_ms_, 0.99);
    }
    return std::nan("");
  }

  Outcome judge(const Expectation& e) const {
    // Contacts are counted over all robots where none is named; all else is that of the worst.
    const bool sum = e.robot.empty() && (e.kind == Kind::contacts || e.kind == Kind::no_collision);
    const double value = sum ? static_cast<double>(watch_.contacts()) : measure(e);
    Outcome outcome{.what = std::string(name_of(e.kind)), .measured = fmt::format("{:.4g}", value), .line = e.line};
    if (!e.robot.empty()) outcome.what += " of " + e.robot;
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

  const Scenario& scenario_;
  world::World world_;
  Simulation simulation_;
  Watch watch_;
  std::map<std::uint32_t, OwnMap> maps_;  ///< by mover
  std::vector<double> tick_ms_;
};

}  // namespace

bool ScenarioResult::passed() const {
  return std::all_of(outcomes.begin(), outcomes.end(), [](const Outcome& o) { return o.met; });
}

ScenarioResult run_scenario(const Scenario& scenario, gpu::Device& device,
                            const std::function<void(double)>& progress) {
  ScenarioResult result{.name = scenario.name, .file = scenario.file};
  Run run(scenario, device);
  run.go(progress, result);
  return result;
}

}  // namespace sf::scenarios
