#include "scenarios/trial.h"

#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include "base/elapsed.h"
#include "base/random.h"
#include "raycast/caster_choice.h"
#include "record/recorder.h"
#include "scenarios/coverage.h"
#include "scenarios/run_info.h"
#include "sensors/laser_settings.h"
#include "sensors/settings.h"

namespace sf::scenarios {

namespace {

/// Key of the draws of `place`, distinct from those of cloned fleets.
constexpr std::uint32_t kStart = 0x57A27u;

/// The trial's value of `noise`, in the file's units; empty: none.
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
      if (world.movers[row].is_tag && simulation.controller(row) == nullptr) continue;
      rows_.push_back(row);
      tracks_.push_back({.name = world.movers[row].name});
      dead_end_detectors_.emplace_back(2.0 * world.movers[row].radius, world.interval);
      helped_.push_back(0);
      if (maps && !sensors::lasers_of(world.movers[row]).empty()) maps_.try_emplace(row, world, row);
    }
  }

  void update(const base::TickRecord& tick, const Simulation& simulation) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      tracks_[i].poses.push_back(tick.reports[rows_[i]].X_WM);
      tracks_[i].contacts.push_back(tick.contacts[rows_[i]]);
      dead_end_detectors_[i].update(tick.reports[rows_[i]], tick.contacts[rows_[i]] != 0);
    }
    add_scans(tick.readings, maps_);
    const control::Controller* first = rows_.empty() ? nullptr : simulation.controller(rows_[0]);
    if (first != nullptr && simulation.stepped(rows_[0]) && std::isfinite(first->error()))
      times_.push_back(1e-9 * static_cast<double>(tick.time));
  }

  void intervention(const base::Report& before, const base::Pose& X_WM) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (rows_[i] != before.mover) continue;
      ++helped_[i];
      dead_end_detectors_[i].turned_by_hand(before, base::wrap_angle(X_WM.yaw - before.X_WM.yaw));
    }
  }

  void give(const RunMetrics& metrics, const world::World& world, const Simulation& simulation, Trial& trial) {
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
    for (const auto& [row, map] : maps_) {
      trial.mapped.push_back(row);
      trial.maps.push_back(map.grid());
    }
  }

 private:
  /// Track of the robot's leader.
  std::uint32_t followed_by(std::uint32_t row, const world::World& world, const Simulation& simulation) const {
    const control::Controller* controller = simulation.controller(row);
    const std::uint32_t id = controller == nullptr ? base::kNoId : controller->intent().follows;
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

Trial run_trial(const Scenario& scenario, const world::World& world, gpu::Device& device, const TrialOptions& options) {
  SimulationOptions simulation_options = simulation_of(scenario, world);
  simulation_options.threads = options.threads;
  Simulation simulation(world, device, simulation_options);
  RunMetrics metrics(world, simulation);
  Keeper keeper(world, simulation, options.maps);
  Supervisor supervisor(world, options.supervisor);
  std::optional<record::Recorder> recorder;
  if (!options.record.empty())
    recorder.emplace(options.record, run_info(world, simulation.farm().sensor_set(),
                                              {.seed = scenario.seed,
                                               .record_readings = true,
                                               .caster = raycast::describe_caster(device.info().software)}));

  Trial trial;
  const auto start = std::chrono::steady_clock::now();
  const auto ticks = std::llround(scenario.duration / world.interval);
  std::int64_t tick = 0;
  for (; tick < ticks && !simulation.all_done(); ++tick) {
    if (options.stop && options.stop()) throw Interrupted();
    const base::TickRecord record = simulation.step();
    metrics.update(record);
    keeper.update(record, simulation);
    if (recorder) recorder->write(record);
    for (const Supervisor::Intervention& intervention : supervisor.update(record)) {
      keeper.intervention(record.reports[intervention.mover], intervention.X_WM);
      metrics.put(intervention.mover, intervention.X_WM);
      simulation.put(intervention.mover, intervention.X_WM);
    }
  }
  if (recorder) recorder->finish();
  trial.wall = base::seconds_since(start);
  trial.decided = simulation.move_seconds();
  trial.simulated = static_cast<double>(tick) * world.interval;
  trial.done = simulation.all_done();
  trial.hash = simulation.farm().hash();
  keeper.give(metrics, world, simulation, trial);
  return trial;
}

}  // namespace sf::scenarios
