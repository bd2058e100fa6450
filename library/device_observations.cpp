// Observations of worlds on a device.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/error.h"
#include "gpu/shared_memory.h"
#include "library/device_worlds_state.h"
#include "robots/device/records.h"
#include "sensors/laser.h"

namespace sensorfarm {

using namespace sf;

void DeviceWorlds::State::observe(const ObservationOptions& options) {
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
                                            .goal_reach = options.goal_reach,
                                            .stack = options.stack};
  for (std::size_t i = 0; i < checked.agents.size(); ++i)
    settings.agents.push_back({checked.agents[i].forward, checked.agents[i].turn, checked.rows[i], 0, 0, 0});
  for (const double limit : checked.limits) settings.sensors.push_back({limit, 0.0});
  const gpu::ExportScope shared(*device);
  auto made = std::make_shared<robots::DeviceObserver>(settings, *device, *fleet, scanner->table());
  observer.swap(made);
  checked.values = {};  // they are on the device
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

namespace {

/// A table's memory as long as somebody uses it: `observe` replaces the observer.
struct Kept {
  std::shared_ptr<void> worlds, observer;
  std::shared_ptr<gpu::CudaMemory> cuda;
};

}  // namespace

/// Submits pending changes of the device's memory, so that no later submission overwrites values that consumers write.
void DeviceWorlds::State::flush() {
  changed();
  scan_starts();
}

DeviceArray DeviceWorlds::State::array(DeviceTable table) {
  const bool commanded = table == DeviceTable::commands;
  if (!commanded && !observer) throw base::InputError("nothing is observed; call observe first");
  DeviceArray made;
  made.single = table == DeviceTable::observations;
  made.rows = commanded ? poses.size() : observed->rows.size();
  made.columns = commanded ? 3 : made.single ? observed->columns() : 1;
  made.stride = (commanded ? sizeof(robots::FleetCommand) : sizeof(robots::ObservedMeasure)) / sizeof(double);
  if (made.single) made.stride = made.columns;
  gpu::Buffer& from = commanded ? fleet->commands() : made.single ? observer->table() : observer->measures();
  const auto cuda = gpu::CudaMemory::of(from);
  auto* const first = cuda ? static_cast<std::byte*>(cuda->data()) : from.host<std::byte>().data();
  made.data = first + (table == DeviceTable::distances  ? offsetof(robots::ObservedMeasure, distance)
                       : table == DeviceTable::progress ? offsetof(robots::ObservedMeasure, progress)
                                                        : 0);
  made.cuda = cuda ? cuda->device() : -1;
  made.copied = !cuda && !device->unified();
  made.memory = std::make_shared<Kept>(Kept{shared_from_this(), observer, cuda});
  if (commanded && cuda && !commands_there) commands_there = true, flush();
  return made;
}

void DeviceWorlds::State::update() { observer ? read_observations() : scan_starts(); }

}  // namespace sensorfarm
