#include "scenarios/trial.h"

#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include "base/bytes.h"
#include "base/elapsed.h"
#include "base/random.h"
#include "cluster/failure.h"
#include "maps/merge.h"
#include "raycast/casters.h"
#include "scenarios/coverage.h"
#include "scenarios/fault_tables.h"
#include "scenarios/run_info.h"
#include "sensors/fiducial.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "sensors/settings.h"

namespace sf::scenarios {

namespace {

/// Key of the random numbers of `place`, distinct from those of cloned fleets.
constexpr std::uint32_t kStart = 0x57A27u;

/// Returns the trial's value of `noise`, in the file's units; empty: none.
std::vector<double> noise_for(const world::Sensor& sensor, const Disturbance& d) {
  if (sensor.type == "laneedge" && d.edge_noise > 0.0) return {d.edge_noise / sensor.metres_per_unit, 0.0, 0.0};
  if (sensor.type == "magnetometer" && d.field_noise > 0.0) return {d.field_noise};
  if (sensors::is_laser(sensor.type) && d.scan_noise > 0.0) return {d.scan_noise / sensor.metres_per_unit, 0.0, 0.0};
  return {};
}

void add_noise(world::Mover& mover, const Disturbance& d) {
  for (world::Sensor& sensor : mover.sensors) {
    if (sensors::find(sensor, "noise") != nullptr) continue;
    const std::vector<double> noise = noise_for(sensor, d);
    if (!noise.empty()) sensor.settings.push_back({"noise", noise, "", sensor.line, sensor.file});
  }
}

/// Collects the tracks of all movers with a controller.
class Keeper {
 public:
  Keeper(const world::World& world, const Simulation& simulation, bool maps) {
    for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
      if (world.movers[row].is_tag && !simulation.status(row).drives) continue;
      rows_.push_back(row);
      tracks_.push_back({.name = world.movers[row].name});
      dead_end_detectors_.emplace_back(2.0 * world.movers[row].radius, world.interval);
      helped_.push_back(0);
      const auto lasers = simulation.farm().sensor_set().of(sensors::kLaser, row);
      if (maps && simulation.share().owns(row) && !lasers.empty()) maps_.try_emplace(row, world, lasers.front());
    }
  }

  void update(const base::TickRecord& tick, const Simulation& simulation) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      tracks_[i].poses.push_back(tick.reports[rows_[i]].X_WM);
      tracks_[i].contacts.push_back(tick.contacts[rows_[i]]);
      dead_end_detectors_[i].update(tick.reports[rows_[i]], tick.contacts[rows_[i]] != 0);
    }
    add_scans(tick.readings, maps_);
    add_sightings(tick.readings);
    const ControlStatus first = rows_.empty() ? ControlStatus{} : simulation.status(rows_[0]);
    if (first.stepped && std::isfinite(first.error)) times_.push_back(1e-9 * static_cast<double>(tick.time));
  }

  void intervention(const base::Report& before, const base::Pose& X_WM) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (rows_[i] != before.mover) continue;
      ++helped_[i];
      dead_end_detectors_[i].turned_by_hand(before, base::wrap_angle(X_WM.yaw - before.X_WM.yaw));
    }
  }

  void give(const RunMetrics& metrics, const world::World& world, const Simulation& simulation, cluster::Ranks* ranks,
            Trial& trial) {
    for (const std::uint32_t row : rows_) trial.follows.push_back(followed_by(row, world, simulation));
    trial.rows = rows_;
    trial.tracks = std::move(tracks_);
    trial.dead_ends = std::move(dead_end_detectors_);
    trial.interventions = std::move(helped_);
    trial.times = std::move(times_);
    for (viz::Track& track : trial.tracks) track.duration = trial.simulated;
    for (const std::uint32_t row : rows_) {
      trial.counts.push_back(metrics.of(row));
      trial.errors.push_back(statistics_of(metrics.of(row).errors));
    }
    for (const auto& [id, sighting] : ranks == nullptr ? sightings_ : sightings_of_all(*ranks))
      trial.sightings.push_back(sighting);
    for (auto& [row, grid] : ranks == nullptr ? own_maps() : maps_of_all(*ranks)) {
      trial.mapped.push_back(row);
      trial.maps.push_back(std::move(grid));
    }
  }

 private:
  using Grids = std::map<std::uint32_t, maps::OccupancyGrid>;  ///< by row of the mover

  Grids own_maps() const {
    Grids grids;
    for (const auto& [row, map] : maps_) grids.emplace(row, map.grid());
    return grids;
  }

  Grids maps_of_all(cluster::Ranks& ranks) const {
    base::Bytes block;
    base::ByteWriter out(block);
    for (const auto& [row, map] : maps_) {
      const maps::GridGeometry& g = map.grid().geometry;
      out.put(row);
      for (const double value : {g.left, g.top, g.cell}) out.put(value);
      for (const std::uint32_t size : {g.word_columns, g.word_rows}) out.put(size);
      for (const std::uint32_t word : map.grid().words) out.put(word);
    }
    Grids grids;
    for (const cluster::Block other : ranks.exchange(block))
      for (base::ByteReader in(other); in.left() > 0;) {
        const auto row = in.get<std::uint32_t>();
        maps::GridGeometry g;
        for (double* value : {&g.left, &g.top, &g.cell}) *value = in.get<double>();
        for (std::uint32_t* size : {&g.word_columns, &g.word_rows}) *size = in.get<std::uint32_t>();
        for (std::uint32_t& word : grids.emplace(row, g).first->second.words) word = in.get<std::uint32_t>();
      }
    return grids;
  }

  void add_sightings(std::span<const base::ReadingBlock> readings) {
    for (const base::ReadingBlock& reading : readings) {
      if (reading.type != sensors::kFiducial) continue;
      for (std::size_t i = 0; i + sensors::kFiducialNumbers <= reading.values.size(); i += sensors::kFiducialNumbers) {
        const auto row = reading.values.subspan(i, sensors::kFiducialNumbers);
        if (!(row[0] > 0.0)) continue;
        const auto id = static_cast<std::uint32_t>(row[0]);
        const glm::dvec2 p = base::transform(reading.X_WS, row[2] * base::rotate(row[3], {1.0, 0.0}));
        add(sightings_,
            {id, static_cast<std::uint32_t>(row[1]), reading.mover, 1e-9 * static_cast<double>(reading.time), p});
      }
    }
  }

  using Sightings = std::map<std::uint32_t, Sighting>;  ///< by id

  /// Keeps the first sighting of each id; of several at one time that of the first robot.
  static void add(Sightings& sightings, const Sighting& sighting) {
    const auto [at, is_new] = sightings.try_emplace(sighting.id, sighting);
    const auto order = [](const Sighting& s) { return std::pair(s.time, s.mover); };
    if (!is_new && order(sighting) < order(at->second)) at->second = sighting;
  }

  Sightings sightings_of_all(cluster::Ranks& ranks) const {
    base::Bytes block;
    base::ByteWriter out(block);
    for (const auto& [id, s] : sightings_) {
      for (const std::uint32_t number : {id, s.type, s.mover}) out.put(number);
      for (const double number : {s.time, s.p.x, s.p.y}) out.put(number);
    }
    Sightings all;
    for (const cluster::Block other : ranks.exchange(block))
      for (base::ByteReader in(other); in.left() > 0;) {
        Sighting s;
        for (std::uint32_t* number : {&s.id, &s.type, &s.mover}) *number = in.get<std::uint32_t>();
        for (double* number : {&s.time, &s.p.x, &s.p.y}) *number = in.get<double>();
        add(all, s);
      }
    return all;
  }

  /// Returns the track of the robot's leader.
  std::uint32_t followed_by(std::uint32_t row, const world::World& world, const Simulation& simulation) const {
    const std::uint32_t id = simulation.intent(row).follows;
    for (std::size_t i = 0; i < rows_.size() && id != base::kNoId; ++i)
      if (!world.movers[rows_[i]].is_tag && world.movers[rows_[i]].id == id) return static_cast<std::uint32_t>(i);
    return world::kNone;
  }

  std::vector<std::uint32_t> rows_;
  std::vector<viz::Track> tracks_;
  std::vector<DeadEndDetector> dead_end_detectors_;
  std::vector<std::uint32_t> helped_;
  std::vector<double> times_;
  std::map<std::uint32_t, RobotMap> maps_;
  Sightings sightings_;
};

}  // namespace

world::World disturbed_world(const Scenario& scenario, const Disturbance& disturbance) {
  world::World world = world_of(scenario);
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    world::Mover& mover = world.movers[row];
    if (mover.is_tag) continue;
    const base::RandomKey draw{scenario.seed, base::RandomStream::placement, kStart, row, 0};
    const auto place = base::random_normal(draw, 0);
    const double turn = base::random_normal(draw, 1)[0];
    mover.X_WM = base::compose(
        mover.X_WM, {disturbance.place * place[0], disturbance.place * place[1], 0.0, disturbance.heading * turn});
    add_noise(mover, disturbance);
  }
  world::update_extent_and_hash(world);
  return world;
}

record::RecordingPart recording_part_of(const cluster::Ranks* ranks, record::Compression compression) {
  if (ranks == nullptr) return {.compression = compression};
  return {ranks->rank(), ranks->size(), compression};
}

namespace {

/// A trial's simulation and recording, as all ranks start them.
struct Course {
  std::optional<Simulation> simulation;
  std::optional<record::Recorder> recorder;

  Course(const Scenario& scenario, const world::World& world, gpu::Device& device, const TrialOptions& options) {
    SimulationOptions simulation_options = simulation_of(scenario, world);
    simulation_options.threads = options.threads;
    simulation_options.ranks = options.ranks;
    cluster::agree(options.ranks, [&] {
      simulation.emplace(world, device, simulation_options);
      if (options.ranks == nullptr) simulation->interrupt_on(options.stop);
      if (options.record.empty()) return;
      recorder.emplace(options.record,
                       run_info(world, simulation->farm().sensor_set(),
                                {.seed = scenario.seed,
                                 .record_readings = true,
                                 .caster = raycast::describe_caster(device.info().software),
                                 .naming = {.odometry = record::OdometrySource::exact},  // also with ranks
                                 .faults = faults_text(scenario.faults)}),
                       recording_part_of(options.ranks, options.compression));
    });
  }

  /// Simulates one tick.
  /// @throws Interrupted on all ranks if one was stopped
  base::TickRecord step(const TrialOptions& options) {
    const bool stop = options.stop && options.stop();
    if (stop && options.ranks == nullptr) throw Interrupted();
    if (stop) simulation->share().request_stop();
    const base::TickRecord record = simulation->step();
    if (recorder) recorder->write(record);
    simulation->settle();
    if (simulation->share().stop_agreed()) throw Interrupted();
    return record;
  }
};

}  // namespace

namespace {

std::optional<maps::OccupancyGrid> merged_own_maps(const world::World& world, const Simulation& simulation) {
  std::vector<const maps::OccupancyGrid*> grids;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m)
    if (const control::Controller* controller = simulation.controller(m); controller && controller->own_map())
      grids.push_back(controller->own_map());
  if (grids.empty() || !maps::merge_problem(grids).empty()) return std::nullopt;
  return maps::merge(grids);
}

}  // namespace

Trial run_trial(const Scenario& scenario, const world::World& world, gpu::Device& device, const TrialOptions& options) {
  Course course(scenario, world, device, options);
  Simulation& simulation = *course.simulation;
  RunMetrics metrics(world, simulation);
  Keeper keeper(world, simulation, options.maps);
  Supervisor supervisor(world, options.supervisor);
  Trial trial;
  const auto start = std::chrono::steady_clock::now();
  const auto ticks = std::llround(scenario.duration / world.interval);
  std::int64_t tick = 0;
  for (; tick < ticks && !simulation.all_done(); ++tick) {
    const base::TickRecord record = course.step(options);
    metrics.update(record);
    keeper.update(record, simulation);
    for (const Supervisor::Intervention& intervention : supervisor.update(record)) {
      keeper.intervention(record.reports[intervention.mover], intervention.X_WM);
      metrics.put(intervention.mover, intervention.X_WM);
      simulation.put(intervention.mover, intervention.X_WM);
    }
  }
  if (course.recorder) course.recorder->finish();
  trial.wall = base::seconds_since(start);
  trial.decided = simulation.move_seconds();
  trial.simulated = static_cast<double>(tick) * world.interval;
  trial.done = simulation.all_done();
  trial.hash = simulation.farm().hash();
  trial.own_map = merged_own_maps(world, simulation);
  keeper.give(metrics, world, simulation, options.ranks, trial);
  return trial;
}

}  // namespace sf::scenarios
