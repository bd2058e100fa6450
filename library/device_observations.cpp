// What worlds on a device observe.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
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

/// Keeps a table's memory as long as somebody uses it: `observe` replaces the observer.
DeviceArray DeviceWorlds::State::array(DeviceTable table) {
  if (table != DeviceTable::commands && !observer) throw base::InputError("nothing is observed; call observe first");
  constexpr std::size_t kCommand = sizeof(robots::FleetCommand) / sizeof(double);
  constexpr std::size_t kMeasure = sizeof(robots::ObservedMeasure) / sizeof(double);
  const auto doubles = [](gpu::Buffer& buffer, std::size_t column) { return buffer.host<double>().data() + column; };
  DeviceArray made{.copied = !device->unified()};
  made.memory = std::make_shared<std::pair<std::shared_ptr<State>, std::shared_ptr<robots::DeviceObserver>>>(
      shared_from_this(), observer);
  made.rows = observed && table != DeviceTable::commands ? observed->rows.size() : poses.size();
  made.columns = made.stride = 1;
  switch (table) {
    case DeviceTable::observations:
      made.columns = made.stride = observed->columns(), made.single = true;
      made.data = observer->table().host<float>().data();
      break;
    case DeviceTable::commands:
      made.columns = 3, made.stride = kCommand, made.data = doubles(fleet->commands(), 0);
      break;
    case DeviceTable::distances:
      made.stride = kMeasure, made.data = doubles(observer->measures(), 2);
      break;
    case DeviceTable::progress:
      made.stride = kMeasure, made.data = doubles(observer->measures(), 3);
  }
  return made;
}

void DeviceWorlds::State::update() { observer ? read_observations() : scan_starts(); }

}  // namespace sensorfarm
