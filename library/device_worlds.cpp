#include "sensorfarm/device_worlds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/time.h"
#include "control/own_controller.h"
#include "library/device_support.h"
#include "library/errors.h"
#include "library/loading.h"
#include "library/observations.h"
#include "raycast/pose_scanner.h"
#include "robots/device/device_fleet.h"
#include "robots/device/device_observer.h"
#include "sensors/laser.h"
#include "sensors/laser_modes.h"
#include "sensors/sensor_set.h"

namespace sensorfarm {

using namespace sf;

namespace {

std::vector<raycast::Scanner> scanners_of(const sensors::SensorSet& sensor_set, bool noise) {
  std::vector<raycast::Scanner> scanners;
  for (const sensors::CastLaser& cast : sensor_set.settings_of<sensors::CastLaser>(sensors::kLaser)) {
    const sensors::SensorSpec& row = sensor_set.group(sensors::kLaser)->rows[scanners.size()];
    scanners.push_back({cast.laser, row.mover, row.sensor, cast.single});
    if (!noise) scanners.back().scan.noise = {};
  }
  return scanners;
}

/// @param why "": not refused
void check(const std::string& file, const std::string& why) {
  if (!why.empty())
    throw base::InputError(fmt::format("{}: {}; use Simulation with copies (in Python: Worlds)", file, why));
}

/// @param what "": nothing
void check_support(const std::string& file, const std::string& what) {
  check(file, what.empty() ? "" : "worlds on a device do not support " + what);
}

}  // namespace

struct DeviceWorlds::State {
  State(const library::WorldSource& source, const Options& options);
  void step(std::span<const Twist> given);
  void reset(std::span<const std::uint32_t> worlds, std::span<const std::uint64_t> seeds);
  void restart(std::uint32_t copy, std::uint64_t seed);
  void scan_starts();
  void read_states();
  void read_ranges();
  void record();
  void changed();
  void observe(const ObservationOptions& options);
  void set_goals(std::span<const double> goals);
  void read_observations();

  std::shared_ptr<gpu::Device> device;
  library::LoadedWorld loaded;
  world::World& world = loaded.world;
  std::optional<sensors::SensorSet> sensor_set;
  std::optional<raycast::Episodes> episodes;
  std::optional<robots::DeviceFleet> fleet;
  std::optional<raycast::PoseScanner> scanner;
  std::unique_ptr<robots::DeviceObserver> observer;  ///< null: nothing is observed
  std::optional<Observations::State> observed;       ///< its agents
  std::int64_t interval = 0;                         ///< [ns]
  std::vector<Robot> robots;
  std::vector<base::Twist> commands;
  std::vector<Pose> poses;
  std::vector<Twist> velocities;
  std::vector<std::uint32_t> carriers;  ///< per laser
  Readings readings;
  bool starting = true;  ///< worlds have restarted since the last scan
  bool states_read = false, ranges_read = false, observations_read = false;
};

DeviceWorlds::State::State(const library::WorldSource& source, const Options& options) {
  check_support(source.file, library::unsupported_option(options));
  Options wanted = options;
  wanted.require_vulkan = true;
  device = library::shared_device(wanted);
  loaded = library::load(source, options);
  sensor_set.emplace(world);
  check_support(source.file, library::unsupported(world, *sensor_set, options));
  interval = base::nanoseconds(world.interval);
  const std::vector<raycast::Scanner> scanners = scanners_of(*sensor_set, options.noise);
  check(source.file, robots::DeviceFleet::refusal(world, interval));
  check(source.file, raycast::PoseScanner::refusal(scanners));
  episodes.emplace(world, options.seed);
  fleet.emplace(world, *device);
  scanner.emplace(world, scanners, *episodes, *device, fleet->poses(), fleet->absent());
  record();
  for (std::uint32_t row = 0; row < world.movers.size() / world.copies; ++row)
    robots.push_back(control::robot_of({world, row, options.seed, nullptr, nullptr, &*sensor_set}));
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    if (world.movers[row].absent) fleet->set_absent(row, true);
  commands.resize(world.movers.size()), poses.resize(commands.size()), velocities.resize(commands.size());
  for (const raycast::Scanner& each : scanners) carriers.push_back(each.mover);
  const sensors::SensorSet::Group& lasers = *sensor_set->group(sensors::kLaser);
  readings.type = lasers.type->name, readings.robots = carriers, readings.sensors = carriers.size();
  readings.elements = readings.stride = lasers.rows.front().elements;
}

/// Records what follows the motion.
void DeviceWorlds::State::record() {
  fleet->then(
      [this](gpu::Batch& batch) {
        scanner->record(batch);
        if (observer) observer->record(batch);
      },
      [this](gpu::Batch& batch) {
        scanner->prepare(batch, starting);
        if (observer) observer->prepare(batch, starting);
      });
  changed();
}

/// Marks all results as out of date: worlds have restarted, or goals or the observed quantities have changed.
void DeviceWorlds::State::changed() {
  starting = true;
  states_read = ranges_read = observations_read = false;
}

void DeviceWorlds::State::step(std::span<const Twist> given) {
  if (!given.empty() && given.size() != commands.size())
    throw base::InputError(fmt::format("{} commands for {} rows; expected one per row", given.size(), commands.size()));
  for (std::size_t i = 0; i < given.size(); ++i)
    if (!std::isfinite(given[i].forward) || !std::isfinite(given[i].left) || !std::isfinite(given[i].turn))
      throw base::InputError(fmt::format("the command of row {} is ({}, {}, {}); expected finite numbers", i,
                                         given[i].forward, given[i].left, given[i].turn));
  for (std::size_t i = 0; i < given.size(); ++i) commands[i] = {given[i].forward, given[i].left, given[i].turn};
  if (observer) scan_starts();  // measures the distances at the starts
  starting = states_read = ranges_read = observations_read = false;
  fleet->set_commands(commands);
  fleet->move(interval);
}

void DeviceWorlds::State::reset(std::span<const std::uint32_t> worlds, std::span<const std::uint64_t> seeds) {
  library::check_restart(world, worlds, seeds);
  for (std::size_t i = 0; i < worlds.size(); ++i) restart(worlds[i], seeds[i]);
  if (!worlds.empty()) changed();
}

void DeviceWorlds::State::restart(std::uint32_t copy, std::uint64_t seed) {
  std::vector<std::uint32_t> resized;
  loaded.starts.place(world, copy, seed, {}, 0, resized);
  const auto rows = static_cast<std::uint32_t>(robots.size());
  for (std::uint32_t row = copy * rows; row < (copy + 1) * rows; ++row) {
    commands[row] = {};
    fleet->set_state({.mover = row, .X_WM = world.movers[row].X_WM, .velocity = {}});
    fleet->set_absent(row, world.movers[row].absent);
  }
  episodes->begin(copy, seed, 0);
  scanner->restart(copy);
  if (!observer) return;
  const std::size_t agents = observed->rows.size() / world.copies;
  observer->restart(copy * agents, (copy + 1) * agents);
}

/// Scans once at the starts of worlds. All others repeat their last scan, to the same bytes.
void DeviceWorlds::State::scan_starts() {
  if (starting) fleet->stay();
  starting = false;
}

void DeviceWorlds::State::read_states() {
  scan_starts();
  if (states_read) return;
  for (const base::Report& report : fleet->reports()) {
    const base::Pose& X = world.movers[report.mover].absent ? base::kAbsent : report.X_WM;
    poses[report.mover] = {X.x, X.y, X.z, X.yaw};
    velocities[report.mover] = {report.velocity.forward, report.velocity.left, report.velocity.turn};
  }
  states_read = true;
}

void DeviceWorlds::State::read_ranges() {
  scan_starts();
  if (!ranges_read) scanner->read();
  readings.values = scanner->ranges(0).data();
  ranges_read = true;
}

void DeviceWorlds::State::observe(const ObservationOptions& options) {
  if (options.stack > 1)
    throw base::InputError(
        fmt::format("stack is {}; worlds on a device observe 1: keep earlier observations yourself", options.stack));
  if (options.sensor != readings.type)
    throw base::InputError(
        fmt::format("{} has no sensor of type '{}'; expected '{}'", world.file, options.sensor, readings.type));
  const sensors::SensorSet::Group& lasers = *sensor_set->group(sensors::kLaser);
  Observations::State checked(options, world, lasers);
  robots::DeviceObserver::Settings settings{.agents = {},
                                            .sensors = {},
                                            .beams = lasers.rows.front().elements,
                                            .every = options.every,
                                            .speeds = options.speeds,
                                            .goal_reach = options.goal_reach};
  for (std::size_t i = 0; i < checked.agents.size(); ++i)
    settings.agents.push_back({checked.agents[i].forward, checked.agents[i].turn, checked.rows[i], 0, 0, 0});
  for (const double limit : checked.limits) settings.sensors.push_back({limit, 0.0});
  auto made = std::make_unique<robots::DeviceObserver>(settings, *device, *fleet, scanner->table());
  observer.swap(made);
  observed.emplace(std::move(checked));
  record();
}

void DeviceWorlds::State::set_goals(std::span<const double> goals) {
  if (!observer) throw base::InputError("goals of agents that are not observed; call observe first");
  if (goals.size() != observed->goals.size())
    throw base::InputError(fmt::format("{} numbers for the goals of {} agents; expected two for each", goals.size(),
                                       observed->rows.size()));
  if (std::ranges::any_of(goals, [](double x) { return std::isinf(x); }))
    throw base::InputError("a goal is infinite; expected finite numbers, or NaN for none");
  observer->set_goals(goals);
  changed();
}

void DeviceWorlds::State::read_observations() {
  if (!observer) throw base::InputError("nothing is observed; call observe first");
  scan_starts();
  if (!observations_read) observer->read();
  observations_read = true;
}

DeviceWorlds::DeviceWorlds(const std::string& world, const Options& options)
    : state_(library::translated([&] {
        return std::make_shared<State>(library::WorldSource{library::found(world), ""}, options);
      })) {}

DeviceWorlds::DeviceWorlds(std::shared_ptr<State> state) : state_(std::move(state)) {}
DeviceWorlds::DeviceWorlds(DeviceWorlds&&) noexcept = default;
DeviceWorlds& DeviceWorlds::operator=(DeviceWorlds&&) noexcept = default;
DeviceWorlds::~DeviceWorlds() = default;

DeviceWorlds DeviceWorlds::from_text(const std::string& text, const Options& options, const std::string& name) {
  return library::translated([&] {
    return DeviceWorlds(std::make_shared<State>(library::WorldSource{name, text}, options));
  });
}

void DeviceWorlds::step(std::span<const Twist> commands) {
  library::translated([&] { state_->step(commands); });
}
void DeviceWorlds::reset(std::span<const std::uint32_t> worlds, std::span<const std::uint64_t> seeds) {
  library::translated([&] { state_->reset(worlds, seeds); });
}

std::size_t DeviceWorlds::copies() const { return state_->world.copies; }
std::size_t DeviceWorlds::size() const { return state_->commands.size(); }
const std::vector<Robot>& DeviceWorlds::robots() const { return state_->robots; }
double DeviceWorlds::interval() const { return state_->world.interval; }

std::span<const Pose> DeviceWorlds::poses() const {
  library::translated([&] { state_->read_states(); });
  return state_->poses;
}
std::span<const Twist> DeviceWorlds::velocities() const {
  library::translated([&] { state_->read_states(); });
  return state_->velocities;
}
std::span<const std::uint8_t> DeviceWorlds::contacts() const {
  library::translated([&] { state_->read_states(); });
  return state_->fleet->contacts();
}
Readings DeviceWorlds::readings() const {
  library::translated([&] { state_->read_ranges(); });
  return state_->readings;
}

void DeviceWorlds::observe(const ObservationOptions& options) {
  library::translated([&] { state_->observe(options); });
}
void DeviceWorlds::set_goals(std::span<const double> goals) {
  library::translated([&] { state_->set_goals(goals); });
}
std::size_t DeviceWorlds::agents() const { return state_->observed ? state_->observed->rows.size() : 0; }
std::size_t DeviceWorlds::columns() const { return state_->observed ? state_->observed->newest : 0; }
std::span<const float> DeviceWorlds::observations() const {
  library::translated([&] { state_->read_observations(); });
  return state_->observer->values();
}
std::span<const double> DeviceWorlds::distances() const {
  library::translated([&] { state_->read_observations(); });
  return state_->observer->distances();
}
std::span<const double> DeviceWorlds::progress() const {
  library::translated([&] { state_->read_observations(); });
  return state_->observer->progress();
}

}  // namespace sensorfarm
