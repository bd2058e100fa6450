#include "scenarios/vesim_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "base/elementary.h"
#include "base/error.h"
#include "base/random.h"
#include "base/time.h"
#include "cluster/failure.h"
#include "scenarios/simulation.h"
#include "sensors/gps.h"
#include "sensors/illumination.h"
#include "sensors/localization.h"
#include "sensors/tracks.h"
#include "world/ground.h"
#include "world/shapes.h"

namespace sf::scenarios {

namespace {

constexpr double kVesimStart = 5.0;                         // [s] first readings that count
constexpr double kCarAssigned = 4.0;                        // [m] from a car to its track
constexpr double kSurfaceNear = 3.0;                        // [m]
constexpr double kEye = 1.65, kBody = 0.7;                  // [m] height of the lidars, and of the middle of a car
constexpr double kSightStep = 2.0;                          // [m]
constexpr double kAhead = M_PI / 4.0;                       // [rad] half of the radar's field of view
constexpr double kSpeedSpread = 0.15, kStartSpread = 12.0;  // [-], [m] of the other cars

struct VesimCars {
  const world::World& world;
  world::Ground ground;
  std::uint32_t ego = 0;
  std::map<std::pair<std::size_t, std::uint32_t>, double> identities;  ///< the last ones, by choice and car

  bool in_sight(const base::TickRecord& tick, std::uint32_t car) const;
  bool near_surface(glm::dvec2 p) const {
    return std::ranges::any_of(world.walls, [&](const world::Segment& wall) {
      return wall.seen_by_laser && world::distance(p, wall.a, wall.b) < kSurfaceNear;
    });
  }
};

/// Neither the ground nor a house or a tree is in between. Other cars count as lower than the lidars.
bool VesimCars::in_sight(const base::TickRecord& tick, std::uint32_t car) const {
  const base::Pose &a = tick.reports[ego].X_WM, &b = tick.reports[car].X_WM;
  const glm::dvec3 from{a.x, a.y, a.z + kEye}, to{b.x, b.y, b.z + kBody}, d = to - from;
  const double length = glm::length(d);
  for (double s = kSightStep; s < length; s += kSightStep) {
    const glm::dvec3 p = from + s / length * d;
    if (ground.height({p.x, p.y}, HUGE_VAL) > p.z) return false;
  }
  return std::ranges::none_of(world.walls, [&](const world::Segment& wall) {
    return wall.seen_by_laser && sensors::crosses_sight(from, to, wall);
  });
}

/// Returns the cell of a car; null if it is too far away, or hidden.
VesimCell* cell_of(const VesimCars& cars, const base::TickRecord& tick, std::uint32_t car, VesimTracks& sum) {
  const base::Pose &X_WE = tick.reports[cars.ego].X_WM, &X_WC = tick.reports[car].X_WM;
  const double range = base::hypot(X_WC.x - X_WE.x, X_WC.y - X_WE.y);
  const auto end = std::ranges::upper_bound(kVesimRanges, range);
  if (end == kVesimRanges.end() || !cars.in_sight(tick, car)) return nullptr;
  const double bearing = base::wrap_angle(base::atan2(X_WC.y - X_WE.y, X_WC.x - X_WE.x) - X_WE.yaw);
  return &sum.cells[std::abs(bearing) < kAhead ? 0 : 1][static_cast<std::size_t>(end - kVesimRanges.begin())];
}

void compare_cars(VesimCars& cars, const base::TickRecord& tick, const base::ReadingBlock& reading, VesimTracks& sum) {
  ++sum.readings;
  const std::vector<TrackRow> rows = object_rows(reading);
  std::vector<bool> used(rows.size());
  for (std::uint32_t car = 0; car < tick.reports.size(); ++car) {
    if (car == cars.ego) continue;
    const base::Report& truth = tick.reports[car];
    const std::size_t nearest = nearest_row(rows, used, truth.X_WM, kCarAssigned);
    if (nearest < rows.size()) used[nearest] = true;
    VesimCell* const cell = cell_of(cars, tick, car, sum);
    if (cell == nullptr) continue;
    ++cell->targets;
    if (nearest == rows.size()) continue;
    cell->add(rows[nearest], truth);
    const double identity = rows[nearest][sensors::kTrackIdentityAt];
    const auto [last, is_new] = cars.identities.try_emplace({reading.sensor, car}, identity);
    if (!is_new && last->second != identity) ++sum.switches, last->second = identity;
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto near = [&](const base::Report& report) { return distance_to(rows[k], report.X_WM) < kCarAssigned; };
    if (used[k] || std::ranges::any_of(tick.reports, near)) continue;
    const bool moving = rows[k][sensors::kTrackKindAt] == 2.0, surface = cars.near_surface({rows[k][0], rows[k][1]});
    sum.ghosts += moving && !surface, sum.moving_walls += moving && surface, sum.nothings += !moving && !surface;
  }
}

void compare_place(const base::ReadingBlock& reading, VesimPlace& place) {
  const bool is_gps = reading.type == sensors::kGps;
  const base::Pose& X = is_gps ? reading.X_WS : reading.X_WM;
  const std::span<const double> v = reading.values;
  if (!std::isfinite(v[0] + v[1])) return;
  const double ex = v[0] - X.x, ey = v[1] - X.y, error = base::hypot(ex, ey);
  ++place.readings;
  place.squares += error * error;
  place.largest = std::max(place.largest, error);
  place.nees += is_gps ? NAN : position_nees(ex, ey, v[4], v[5], v[7]);
}

std::uint32_t row_of_ego(const world::World& world) {
  const auto ego = std::ranges::find(world.movers, "ego", &world::Mover::name);
  if (ego == world.movers.end())
    throw base::InputError("the world has no car 'ego'; expected worlds/vesim/vesim.world");
  return static_cast<std::uint32_t>(ego - world.movers.begin());
}

/// Gives the car tracks of each choice in place of its own.
void give_choices(world::Mover& ego) {
  const auto own = std::ranges::find(ego.sensors, "tracks", &world::Sensor::type);
  if (own == ego.sensors.end())
    throw base::InputError("the car 'ego' has no tracks; expected worlds/vesim/vesim.world");
  const world::Sensor like = *own;
  ego.sensors.erase(own);
  for (const VesimChoice& choice : kVesimChoices) {
    world::Sensor& each = ego.sensors.emplace_back(like);
    each.name = choice.name;
    for (world::Setting& setting : each.settings)
      if (setting.key == "inputs") setting.text = choice.inputs;
  }
}

/// Moves the starts of the other cars along their lanes, all of which are straight along x there.
void vary(world::World& world, std::uint32_t ego, std::uint64_t seed) {
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    world::Mover& car = world.movers[row];
    if (row == ego) continue;
    const auto [place, pace] = base::random_uniform({seed, base::RandomStream::placement, row, 0, 0}, 0);
    car.X_WM.x += kStartSpread * (2.0 * place - 1.0);
    car.X_WM.z = world::height_on_road(world, {car.X_WM.x, car.X_WM.y}, 0.0);
    for (auto& [key, value] : car.controller_settings)
      if (key == "speed") value = fmt::format("{:.3f}", std::stod(value) * (1.0 + kSpeedSpread * (2.0 * pace - 1.0)));
  }
}

void add_place(VesimPlace& sum, const VesimPlace& other) {
  sum.readings += other.readings, sum.squares += other.squares, sum.nees += other.nees;
  sum.largest = std::max(sum.largest, other.largest);
}

}  // namespace

void VesimRun::add(const VesimRun& other) {
  contacts += other.contacts;
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    VesimTracks& sum = tracks[k];
    const VesimTracks& more = other.tracks[k];
    sum.readings += more.readings, sum.switches += more.switches;
    sum.ghosts += more.ghosts, sum.moving_walls += more.moving_walls, sum.nothings += more.nothings;
    for (std::size_t side = 0; side < sum.cells.size(); ++side)
      for (std::size_t i = 0; i < kVesimRanges.size(); ++i) {
        VesimCell& cell = sum.cells[side][i];
        const VesimCell& with = more.cells[side][i];
        cell.targets += with.targets;
        cell.add(with);
      }
  }
  add_place(gps, other.gps), add_place(fused, other.fused);
}

VesimRun run_vesim(const ExperimentContext& context, std::uint64_t seed) {
  Scenario scenario = context.scenario;
  scenario.seed = seed;
  world::World world = world_of(scenario);
  VesimCars cars{world, world::Ground(world.ramps, world.terrain), row_of_ego(world), {}};
  give_choices(world.movers[cars.ego]);
  vary(world, cars.ego, seed);
  SimulationOptions options = simulation_of(scenario, world);
  options.threads = context.options.threads;
  Simulation simulation(world, context.device, std::move(options));
  VesimRun run{.seed = seed};
  for (double time = 0.0; time < scenario.duration - 1e-6;) {
    if (context.options.stop && context.options.stop()) throw Interrupted();
    const base::TickRecord tick = simulation.step();
    time = 1e-9 * static_cast<double>(tick.time);
    run.contacts += static_cast<std::uint64_t>(std::ranges::count(tick.contacts, 1));
    if (time < kVesimStart) continue;
    for (const base::ReadingBlock& reading : tick.readings) {
      if (reading.mover != cars.ego) continue;
      if (reading.type == sensors::kTracks && reading.time == tick.time)
        compare_cars(cars, tick, reading, run.tracks[reading.sensor]);
      if (reading.type == sensors::kGps) compare_place(reading, run.gps);
      if (reading.type == sensors::kLocalization) compare_place(reading, run.fused);
    }
  }
  run.hash = simulation.farm().hash();
  return run;
}

std::vector<VesimRun> run_vesim_trials(const ExperimentContext& context) {
  static_assert(std::is_trivially_copyable_v<VesimRun>);
  cluster::Ranks* const ranks = context.options.ranks;
  const std::uint32_t size = ranks == nullptr ? 1 : ranks->size(), rank = ranks == nullptr ? 0 : ranks->rank();
  std::vector<VesimRun> runs(context.options.trials);
  base::Bytes own;
  cluster::agree(ranks, [&] {
    for (std::uint32_t k = rank; k < runs.size(); k += size) {
      if (context.progress)
        context.progress(static_cast<double>(k) / context.options.trials, fmt::format("trial {}", k + 1));
      runs[k] = run_vesim(context, context.options.seed + k);
      const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&runs[k]);
      own.insert(own.end(), bytes, bytes + sizeof(VesimRun));
    }
  });
  if (ranks == nullptr) return runs;
  const std::span<const cluster::Block> blocks = ranks->exchange(own);
  for (std::uint32_t k = 0; k < runs.size(); ++k)
    std::memcpy(&runs[k], blocks[k % size].data() + k / size * sizeof(VesimRun), sizeof(VesimRun));
  return runs;
}

}  // namespace sf::scenarios
