#pragma once
// One run of an experiment: a scenario, disturbed a little by its seed, kept whole.

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "maps/grid.h"
#include "scenarios/dead_end_detector.h"
#include "scenarios/run_metrics.h"
#include "scenarios/scenario.h"
#include "scenarios/statistics.h"
#include "scenarios/supervisor.h"
#include "viz/trajectory_figure.h"

namespace sf::scenarios {

/// What differs from trial to trial: normal, drawn from the trial's seed. The thesis' runs had several
/// nondeterministic factors that it does not number; these are ours.
struct Disturbance {
  double place = 0.01;         ///< [m] standard deviation of the start, along and across
  double heading = 0.02;       ///< [rad] of the heading at the start
  double edge_noise = 0.002;   ///< [m] of each ray of a lane edge sensor that has no noise of its own
  double field_noise = 0.002;  ///< [Gauss] of each component of a magnetometer likewise
  double scan_noise = 0.003;   ///< [m] of each beam of a laser likewise
};

/// What is kept of a run.
struct Trial {
  std::vector<viz::Track> tracks;            ///< per robot, and per tag that is driven
  std::vector<std::uint32_t> rows;           ///< of their movers
  std::vector<std::uint32_t> follows;        ///< per track, at the end: the track that it follows; world::kNone: nobody
  std::vector<RobotMetrics> counts;          ///< one per track
  std::vector<ErrorStatistics> errors;       ///< one per track
  std::vector<DeadEndDetector> dead_ends;    ///< one per track
  std::vector<std::uint32_t> interventions;  ///< one per track: how often the supervisor took it by hand
  std::vector<double> times;                 ///< [s] of the first robot's errors
  std::vector<maps::OccupancyGrid> maps;     ///< of each robot with a laser, where asked for
  std::vector<std::uint32_t> mapped;         ///< their rows
  double simulated = 0.0;                    ///< [s]
  double wall = 0.0;                         ///< [s]
  double decided = 0.0;                      ///< [s] of it, spent on controllers and motion
  bool done = false;                         ///< all controllers were
  std::uint64_t hash = 0;                    ///< of all readings
};

struct TrialOptions {
  Disturbance disturbance;
  std::string record;  ///< folder; empty: none
  bool maps = false;
  SupervisorSettings supervisor;  ///< unless told, nobody
  unsigned threads = 0;
  std::function<bool()> stop;  ///< asked each tick; may be empty
};

/// Somebody stopped it.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

/// The scenario's world with the disturbance that belongs to its seed.
world::World disturbed_world(const Scenario& scenario, const Disturbance& disturbance);

/// Until all are done, or the scenario's duration.
/// @throws Interrupted when `options.stop` says so; the recording then ends with the last whole tick.
Trial run_trial(const Scenario& scenario, const world::World& world, gpu::Device& device, const TrialOptions& options);

}  // namespace sf::scenarios
