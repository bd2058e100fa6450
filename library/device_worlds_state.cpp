#include "library/device_worlds_state.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/time.h"
#include "control/own_controller.h"
#include "gpu/shared_memory.h"
#include "library/device_support.h"
#include "robots/device/records.h"
#include "sensors/laser.h"
#include "sensors/laser_modes.h"

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
  const gpu::ExportScope shared(*device);
  fleet.emplace(world, *device);
  scanner.emplace(world, scanners, *episodes, *device, fleet->poses(), fleet->absent());
  record();
  for (std::uint32_t row = 0; row < world.movers.size() / world.copies; ++row)
    robots.push_back(control::robot_of({world, row, options.seed, nullptr, nullptr, &*sensor_set}));
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    if (world.movers[row].absent) fleet->set_absent(row, true);
  poses.resize(world.movers.size()), velocities.resize(poses.size());
  for (const raycast::Scanner& each : scanners) carriers.push_back(each.mover);
  const sensors::SensorSet::Group& lasers = *sensor_set->group(sensors::kLaser);
  readings.type = lasers.type->name, readings.robots = carriers, readings.sensors = carriers.size();
  readings.elements = readings.stride = lasers.rows.front().elements;
}

/// Records the scans and observations that follow the motion.
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
  if (!given.empty() && given.size() != poses.size())
    throw base::InputError(fmt::format("{} commands for {} rows; expected one per row", given.size(), poses.size()));
  for (std::size_t i = 0; i < given.size(); ++i)
    if (!std::isfinite(given[i].forward) || !std::isfinite(given[i].left) || !std::isfinite(given[i].turn))
      throw base::InputError(fmt::format("the command of row {} is ({}, {}, {}); expected finite numbers", i,
                                         given[i].forward, given[i].left, given[i].turn));
  const auto commands = fleet->commands().host<robots::FleetCommand>();
  for (std::size_t i = 0; i < given.size(); ++i) commands[i] = {given[i].forward, given[i].left, given[i].turn, 0.0};
  if (observer) scan_starts();  // measures the distances at the starts
  starting = states_read = ranges_read = observations_read = false;
  if (!given.empty() || !commands_there) fleet->upload_commands(0, commands.size());
  fleet->move(interval);
}

void DeviceWorlds::State::reset(std::span<const std::uint32_t> worlds, std::span<const std::uint64_t> seeds,
                                const WorldStarts& starts) {
  library::check_restart(world, worlds, seeds);
  loaded.starts.check(world, starts, worlds.size() * robots.size());
  check_support(world.file, library::unsupported(starts));
  std::vector<std::uint32_t> resized;  // none: random sizes are not supported
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    loaded.starts.place(world, worlds[i], seeds[i], starts, i * robots.size(), resized);
    episodes->begin(worlds[i], seeds[i], 0);
    restart(worlds[i]);
  }
  if (!worlds.empty()) commands_there ? flush() : changed();
}

/// Takes the starts of a copy that has been placed.
void DeviceWorlds::State::restart(std::uint32_t copy) {
  const auto rows = static_cast<std::uint32_t>(robots.size());
  for (std::uint32_t row = copy * rows; row < (copy + 1) * rows; ++row) {
    fleet->commands().host<robots::FleetCommand>()[row] = {};
    if (commands_there) fleet->upload_commands(row, 1);
    fleet->set_state({.mover = row, .X_WM = world.movers[row].X_WM, .velocity = {}});
    fleet->set_absent(row, world.movers[row].absent);
  }
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

}  // namespace sensorfarm
