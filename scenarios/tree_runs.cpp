#include "scenarios/tree_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/elementary.h"
#include "base/error.h"
#include "base/time.h"
#include "scenarios/simulation.h"
#include "sensors/illumination.h"
#include "sensors/tracks.h"
#include "world/shapes.h"

namespace sf::scenarios {

namespace {

constexpr double kTreeStart = 10.0;   // [s] the localization has converged
constexpr double kSight = 3.0;        // [m] of targets
constexpr double kAssigned = 0.4;     // [m] from a target to its track
constexpr double kNearSurface = 0.3;  // [m]
constexpr double kAtRest = 0.03;      // [m/s]
constexpr double kEyeHeight = 0.02;   // [m]
constexpr unsigned kSonarAlone = 4;

struct TreeRobots {
  const world::World& world;
  std::uint32_t probe = 0;
  std::vector<std::uint32_t> targets;
  std::map<std::pair<unsigned, std::uint32_t>, double> identities;  ///< the last ones, by choice and target

  glm::dvec3 eye(const base::Report& report) const {
    return {report.X_WM.x, report.X_WM.y, report.X_WM.z + kEyeHeight};
  }
  bool in_sight(const base::TickRecord& tick, std::uint32_t target) const;
  bool near_surface(glm::dvec2 p) const;
};

bool TreeRobots::in_sight(const base::TickRecord& tick, std::uint32_t target) const {
  const glm::dvec3 from = eye(tick.reports[probe]), to = eye(tick.reports[target]);
  if (!(base::hypot(to.x - from.x, to.y - from.y) < kSight) || std::abs(to.z - from.z) > kEyeHeight) return false;
  return std::ranges::none_of(world.walls, [&](const world::Segment& wall) {
    return wall.seen_by_laser && sensors::crosses_sight(from, to, wall);
  });
}

bool TreeRobots::near_surface(glm::dvec2 p) const {
  return std::ranges::any_of(world.walls, [&](const world::Segment& wall) {
    return wall.seen_by_laser && wall.z_min <= kEyeHeight && world::distance(p, wall.a, wall.b) < kNearSurface;
  });
}

double speed_of(const base::Report& report) { return base::hypot(report.velocity.forward, report.velocity.left); }

void compare_tracks(TreeRobots& robots, const base::TickRecord& tick, const base::ReadingBlock& reading,
                    TreeTracks& sum) {
  ++sum.readings;
  const std::vector<TrackRow> rows = object_rows(reading);
  sum.tracks += rows.size();
  std::vector<bool> used(rows.size());
  for (const std::uint32_t target : robots.targets) {
    if (!robots.in_sight(tick, target)) continue;
    ++sum.targets;
    const base::Report& truth = tick.reports[target];
    const std::size_t nearest = nearest_row(rows, used, truth.X_WM, kAssigned);
    if (nearest == rows.size()) continue;
    used[nearest] = true;
    sum.TrackErrors::add(rows[nearest], truth);
    sum.right_motion += (rows[nearest][sensors::kTrackKindAt] == 2.0) == (speed_of(truth) > kAtRest);
    const double identity = rows[nearest][sensors::kTrackIdentityAt];
    const auto [last, is_new] = robots.identities.try_emplace({sum.sensors, target}, identity);
    if (!is_new && last->second != identity) ++sum.switches, last->second = identity;
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto near = [&](std::uint32_t target) { return distance_to(rows[k], tick.reports[target].X_WM) < kAssigned; };
    if (used[k] || std::ranges::any_of(robots.targets, near)) continue;
    if (!robots.near_surface({rows[k][0], rows[k][1]}))
      ++sum.false_tracks;
    else
      sum.moving_walls += rows[k][sensors::kTrackKindAt] == 2.0;
  }
}

/// Returns the car's map of all its range sensors.
sensors::Occupancy map_of_probe(const world::World& world, std::uint32_t probe) {
  for (sensors::Occupancy& map : sensors::occupancies_of(world))
    if (map.row.mover == probe && !map.sources.empty()) return map;
  throw base::InputError("the car 'probe' has no map with sources; expected worlds/simville/tree.world");
}

/// Adds tracks of each choice of sensors to the probe, after its own.
void add_choices(world::Mover& probe) {
  const auto own =
      std::ranges::find_if(probe.sensors, [](const world::Sensor& sensor) { return sensor.type == "tracks"; });
  if (own == probe.sensors.end())
    throw base::InputError("the car 'probe' has no tracks; expected worlds/simville/tree.world");
  const world::Sensor like = *own;
  for (unsigned sensors = 1; sensors <= kAllTreeSensors; ++sensors) {
    world::Sensor each = like;
    each.name = fmt::format("tracks-{}", sensors);
    std::string inputs = "localization";
    for (std::size_t k = 0; k < kTreeSensors.size(); ++k)
      if ((sensors >> k & 1u) != 0) inputs += fmt::format("\nfeatures:{}", k);
    for (world::Setting& setting : each.settings)
      if (setting.key == "inputs") setting.text = inputs;
    probe.sensors.push_back(std::move(each));
  }
}

}  // namespace

void TreeTracks::add(const TreeTracks& other) {
  TrackErrors::add(other);
  readings += other.readings, targets += other.targets, right_motion += other.right_motion;
  switches += other.switches, tracks += other.tracks, false_tracks += other.false_tracks;
  moving_walls += other.moving_walls;
}

void TreeRun::add(const TreeRun& other) {
  for (std::size_t row = 0; row < tracks.size(); ++row) tracks[row].add(other.tracks[row]);
  for (std::size_t row = 0; row < grids.size(); ++row) grids[row].add(other.grids[row]);
}

TreeRun run_tree(const ExperimentContext& context, std::uint64_t seed) {
  Scenario scenario = context.scenario;
  scenario.seed = seed;
  world::World world = world_of(scenario);
  const auto probe = std::ranges::find(world.movers, "probe", &world::Mover::name);
  if (probe == world.movers.end())
    throw base::InputError("the world has no car 'probe'; expected worlds/simville/tree.world");
  add_choices(*probe);
  TreeRobots robots{world, static_cast<std::uint32_t>(probe - world.movers.begin()), {}, {}};
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    if (row != robots.probe) robots.targets.push_back(row);
  SimulationOptions options = simulation_of(scenario, world);
  options.threads = context.options.threads;
  Simulation simulation(world, context.device, std::move(options));
  TreeRun run;
  for (unsigned sensors = 1; sensors <= kAllTreeSensors; ++sensors) run.tracks.emplace_back().sensors = sensors;
  TreeGrids grids(world, map_of_probe(world, robots.probe));
  std::int64_t next_look = 0;
  for (double time = 0.0; time < scenario.duration - 1e-6;) {
    if (context.options.stop && context.options.stop()) throw Interrupted();
    const base::TickRecord tick = simulation.step();
    time = 1e-9 * static_cast<double>(tick.time);
    if (time < kTreeStart) continue;
    grids.add(tick);
    if (tick.time >= next_look) grids.look(tick), next_look = tick.time + base::kSecond;
    if (!(time < scenario.duration - 1e-6)) run.grids = grids.compare(tick);
    for (const base::ReadingBlock& reading : tick.readings)
      if (reading.type == sensors::kTracks && reading.mover == robots.probe && reading.sensor > 0 &&
          reading.time == tick.time)
        compare_tracks(robots, tick, reading, run.tracks[reading.sensor - 1]);
  }
  run.own_grids = {maps::to_occupancy(grids.grid(kAllGridSensors, GridPose::own)),
                   maps::to_occupancy(grids.grid(kSonarAlone, GridPose::own))};
  return run;
}

}  // namespace sf::scenarios
