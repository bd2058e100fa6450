#pragma once
// One trial of an experiment: a scenario with a random disturbance from its seed, and its complete results.

#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/thread_pool.h"
#include "cluster/ranks.h"
#include "gpu/device.h"
#include "maps/grid.h"
#include "record/recorder.h"
#include "scenarios/dead_end_detector.h"
#include "scenarios/run_metrics.h"
#include "scenarios/scenario.h"
#include "scenarios/statistics.h"
#include "scenarios/supervisor.h"
#include "viz/trajectory_figure.h"

namespace sf::scenarios {

/// Random differences between trials: normally distributed, drawn from the trial's seed. The thesis mentions several
/// nondeterministic factors without numbers; these values are chosen here. A sensor whose world file has the key
/// `noise` keeps exactly that noise, even if it is 0 or of another kind, for example only angular noise.
struct Disturbance {
  double place = 0.01;         ///< [m] standard deviation of the start position, along and across
  double heading = 0.02;       ///< [rad] standard deviation of the start heading
  double edge_noise = 0.002;   ///< [m] per ray of a lane edge sensor
  double field_noise = 0.002;  ///< [Gauss] per component of a magnetometer
  double scan_noise = 0.003;   ///< [m] per beam of a laser
};

/// The first sighting of a fiducial by any robot of a trial (sensors/fiducial.h).
struct Sighting {
  std::uint32_t id = 0;     ///< > 0
  std::uint32_t type = 0;   ///< world::Fiducial::Type
  std::uint32_t mover = 0;  ///< row of the robot
  double time = 0.0;        ///< [s] simulated
  glm::dvec2 p{};           ///< [m] world frame, as measured
};

/// Results of one run.
struct Trial {
  std::vector<viz::Track> tracks;              ///< per robot, and per tag with a controller
  std::vector<std::uint32_t> rows;             ///< rows of their movers
  std::vector<std::uint32_t> follows;          ///< per track: track of the leader at the end; world::kNone: none
  std::vector<RobotMetrics> counts;            ///< one per track
  std::vector<ErrorStatistics> errors;         ///< one per track
  std::vector<DeadEndDetector> dead_ends;      ///< one per track
  std::vector<std::uint32_t> interventions;    ///< one per track: number of the supervisor's interventions
  std::vector<double> times;                   ///< [s] of the first robot's errors
  std::vector<maps::OccupancyGrid> maps;       ///< of each robot with a laser, if requested
  std::vector<std::uint32_t> mapped;           ///< rows of the movers of `maps`
  std::optional<maps::OccupancyGrid> own_map;  ///< merged maps that controllers keep; nullopt: none, or not mergeable
  std::vector<Sighting> sightings;             ///< one per fiducial that was seen, in order of ids
  double simulated = 0.0;                      ///< [s]
  double wall = 0.0;                           ///< [s]
  double decided = 0.0;                        ///< [s] of `wall`, spent on controllers and motion
  bool done = false;                           ///< all controllers have finished
  std::uint64_t hash = 0;                      ///< of all readings
};

struct TrialOptions {
  Disturbance disturbance;
  std::string record;                                           ///< folder of the recording; empty: none
  record::Compression compression = record::Compression::zstd;  ///< of the recording
  bool maps = false;
  SupervisorSettings supervisor;  ///< default: no supervisor
  unsigned threads = 0;
  std::function<bool()> stop;       ///< polled each tick and within long ones; true stops the trial; may be empty
  cluster::Ranks* ranks = nullptr;  ///< share the fleet, and all run the trial; null: none
};

/// Thrown if `TrialOptions::stop` stopped the trial.
using base::Interrupted;

/// Returns the part of a recording with readings that this process writes.
/// @param ranks may be null
record::RecordingPart recording_part_of(const cluster::Ranks* ranks, record::Compression compression);

/// Returns the scenario's world with the disturbance drawn from its seed.
world::World disturbed_world(const Scenario& scenario, const Disturbance& disturbance);

/// Runs until all controllers are done or the scenario's duration is over. With ranks, all have its results, except the
/// hash, which only the first has; each records its part of the recording.
/// @throws Interrupted if `options.stop` returns true; the recording then ends with the last complete tick
Trial run_trial(const Scenario& scenario, const world::World& world, gpu::Device& device, const TrialOptions& options);

}  // namespace sf::scenarios
