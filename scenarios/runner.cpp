#include "scenarios/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include "base/bytes.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "cluster/failure.h"
#include "scenarios/coverage.h"
#include "scenarios/expectations.h"
#include "scenarios/scenario_events.h"
#include "scenarios/visible_area.h"
#include "sensors/laser.h"
#include "world/roads/roads.h"

namespace sf::scenarios {

namespace {

using Kind = Expectation::Kind;
using Clock = std::chrono::steady_clock;

bool expects(const Scenario& scenario, Kind kind) {
  return std::any_of(scenario.expect.begin(), scenario.expect.end(),
                     [&](const Expectation& e) { return e.kind == kind; });
}

/// Returns the line of the file that sets the mover's controller.
int line_of_driver(const Scenario& scenario, const world::Mover& mover) {
  for (const RobotSetup& setup : scenario.robot_setups)
    if (setup.actor && setup.name == mover.name) return setup.controller_line;
  for (const ObjectEvent& event : scenario.events)
    if (event.kind == ObjectEvent::Kind::add && event.object == mover.name) return event.line;
  return scenario.default_line;
}

/// Adds the line that names the controller to its errors that have no location.
control::ConfiguredController try_controller(const Scenario& scenario, const control::ControllerContext& site,
                                             const control::ControllerConfig& config) {
  try {
    return control::make_controller(site, config);
  } catch (const base::InputError& error) {
    const std::string what = error.what();
    if (!config.at.empty() || what.starts_with(scenario.file + ":")) throw;
    throw base::InputError(scenario.file, line_of_driver(scenario, site.world.movers[site.mover]), what);
  }
}

/// One run with its metrics.
class Run {
 public:
  Run(const Scenario& scenario, gpu::Device& device, unsigned threads, cluster::Ranks* ranks)
      : scenario_(scenario),
        ranks_(ranks),
        world_(world_of(scenario)),
        simulation_(world_, device, options_of(scenario, world_, threads, ranks)),
        events_(scenario),
        metrics_(world_, simulation_) {
    for (std::uint32_t row = 0; row < world_.movers.size(); ++row) add_map(row);
    simulation_.change_shapes_in(world_);
  }

  void go(const std::function<void(double)>& progress, const std::function<bool()>& stop, ScenarioResult& result) {
    if (stop && ranks_ == nullptr) simulation_.interrupt_on(stop);
    const auto ticks = static_cast<std::uint64_t>(std::llround(scenario_.duration / world_.interval));
    const bool until_done = expects(scenario_, Kind::done);
    const double driven = maps_.empty() ? 1.0 : 0.9;  // of the progress; maps are compared afterwards
    const auto start = Clock::now();
    for (; result.ticks < ticks && !(until_done && simulation_.all_done()); ++result.ticks) {
      events_.apply(simulation_, world_, static_cast<double>(result.ticks) * world_.interval, [&](std::uint32_t row) {
        metrics_.add_mover();
        add_map(row);
      });
      const bool stops = stop && stop();
      if (stops && ranks_ == nullptr) throw base::Interrupted();
      if (stops) simulation_.share().request_stop();
      const auto begin = Clock::now();
      const base::TickRecord tick = simulation_.step();
      simulation_.settle();
      if (simulation_.share().stop_agreed()) throw base::Interrupted();
      tick_ms_.push_back(1e3 * base::seconds_since(begin));
      metrics_.update(tick);
      add_scans(tick.readings, maps_);
      if (progress && result.ticks % 16 == 0)
        progress(driven * static_cast<double>(result.ticks) / static_cast<double>(ticks));
    }
    result.wall = base::seconds_since(start);
    result.simulated = static_cast<double>(result.ticks) * world_.interval;
    result.hash = simulation_.farm().hash();
    cover([&](double part) {
      if (stop && stop() && ranks_ == nullptr) throw base::Interrupted();
      if (progress) progress(driven + (1.0 - driven) * part);
    });
    const MeasuredRun run{scenario_, world_, metrics_, coverages_, tick_ms_, simulation_.all_done()};
    for (const Expectation& e : scenario_.expect) result.outcomes.push_back(judge(run, e));
    result.metrics = metrics_of(run);
  }

 private:
  static SimulationOptions options_of(const Scenario& scenario, const world::World& world, unsigned threads,
                                      cluster::Ranks* ranks) {
    SimulationOptions options = simulation_of(scenario, world);
    options.threads = threads;
    options.ranks = ranks;
    return options;
  }

  /// Adds the map of a robot whose map is expected.
  void add_map(std::uint32_t row) {
    const world::Mover& mover = world_.movers[row];
    const bool expected = std::any_of(scenario_.expect.begin(), scenario_.expect.end(), [&](const Expectation& e) {
      return e.kind == Kind::map_coverage && (e.robot.empty() ? !mover.is_tag : e.robot == mover.name);
    });
    const auto lasers = simulation_.farm().sensor_set().of(sensors::kLaser, row);
    if (expected && simulation_.share().owns(row) && !lasers.empty()) maps_.try_emplace(row, world_, lasers.front());
  }

  /// Compares all maps with the visible areas; each rank has the maps of its own robots.
  void cover(const std::function<void(double)>& progress) {
    base::Bytes block;
    base::ByteWriter out(block);
    VisibleArea reference(world_, simulation_.farm().sensor_set());
    for (const auto& [row, map] : maps_) {
      const Coverage seen = coverage_of(map.grid(), reference.of(row, map.grid().geometry, [&](double part) {
        progress((static_cast<double>(coverages_.size()) + part) / static_cast<double>(maps_.size()));
      }));
      coverages_[row] = seen.coverage();
      out.put(row);
      out.put(seen.coverage());
    }
    if (ranks_ == nullptr) return;
    for (const cluster::Block other : ranks_->exchange(block))
      for (base::ByteReader in(other); in.left() > 0;) {
        const auto row = in.get<std::uint32_t>();
        coverages_[row] = in.get<double>();
      }
  }

  const Scenario& scenario_;
  cluster::Ranks* ranks_;
  world::World world_;
  Simulation simulation_;
  ScenarioEvents events_;
  RunMetrics metrics_;
  std::map<std::uint32_t, RobotMap> maps_;     ///< of this rank, by row of the mover
  std::map<std::uint32_t, double> coverages_;  ///< [-] of all ranks, by row of the mover, after the run
  std::vector<double> tick_ms_;
};

}  // namespace

ScenarioStatus ScenarioResult::status() const {
  if (!failure.empty()) return ScenarioStatus::failed;
  if (outcomes.empty()) return ScenarioStatus::no_expectations;
  const bool met = std::all_of(outcomes.begin(), outcomes.end(), [](const ExpectationResult& o) { return o.met; });
  return met ? ScenarioStatus::passed : ScenarioStatus::failed;
}

std::vector<world::Warning> check_scenario(const Scenario& scenario) {
  world::World world = world_of(scenario);
  if (std::llround(scenario.duration / world.interval) < 1)
    throw base::InputError(scenario.file, scenario.duration_line,
                           fmt::format("'duration' {:g} s is shorter than a tick of {:g} s, so nothing would be "
                                       "simulated; expected at least one tick",
                                       scenario.duration, world.interval));
  if (std::all_of(world.movers.begin(), world.movers.end(), [](const world::Mover& mover) { return mover.is_tag; }))
    world.warnings.push_back({scenario.world, 0, "has no robot to drive: add one to a world that includes it"});
  SimulationOptions options = simulation_of(scenario, world);
  check_events(scenario, world, options);
  const std::optional<world::RoadNetwork> roads = world::roads_of(world);
  const sensors::SensorSet sensor_set(world);
  farm::check_faults(scenario.faults, world, sensor_set);
  std::vector<control::ConfiguredController> made;  // kept to the end: robots of one shape share their corridors
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    const control::ControllerConfig& config = options.actors[m].controller;
    if (!config.name.empty())
      made.push_back(
          try_controller(scenario, {world, m, options.seed, roads ? &*roads : nullptr, nullptr, &sensor_set}, config));
  }
  for (const Expectation& e : scenario.expect) check_expectation(scenario, world, options, e);
  return std::move(world.warnings);
}

ScenarioResult run_scenario(const Scenario& scenario, gpu::Device& device, const std::function<void(double)>& progress,
                            unsigned threads, cluster::Ranks* ranks, const std::function<bool()>& stop) {
  ScenarioResult result{.name = scenario.name, .file = scenario.file};
  std::optional<Run> run;
  cluster::agree(ranks, [&] {
    check_scenario(scenario);
    run.emplace(scenario, device, threads, ranks);
  });
  run->go(progress, stop, result);
  return result;
}

}  // namespace sf::scenarios
