#include "robots/device/device_observer.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "gpu/group_counts.h"
#include "robots/device/device_tables.h"
#include "shaders/observe.comp.h"

namespace sf::robots {

namespace {

using gpu::Role;

ObserveTick observe_tick(const DeviceObserver::Settings& settings) {
  const auto agents = static_cast<std::uint32_t>(settings.agents.size());
  ObserveTick tick{.agents = agents,
                   .sensors = static_cast<std::uint32_t>(settings.sensors.size()) / agents,
                   .beams = settings.beams,
                   .elements = (settings.beams + settings.every - 1) / settings.every,
                   .every = settings.every,
                   .columns = 0,
                   .speeds = settings.speeds ? 1u : 0u,
                   .again = 0,
                   .reach = settings.goal_reach,
                   .stack = settings.stack,
                   .spare = 0};
  tick.columns = tick.sensors * tick.elements + (settings.speeds ? 2 : 0) + (settings.goal_reach > 0.0 ? 3 : 0);
  return tick;
}

std::size_t count_of(const ObserveTick& tick) { return std::size_t{tick.agents} * tick.columns * tick.stack; }

// Bits of `fresh`.
constexpr std::uint32_t kNewGoal = 1, kNewEpisode = 2;

}  // namespace

DeviceObserver::DeviceObserver(const Settings& settings, gpu::Device& device, const DeviceFleet& fleet,
                               const gpu::Buffer& ranges)
    : value_count_(count_of(observe_tick(settings))),
      distances_(settings.agents.size()),
      progress_(settings.agents.size()),
      tick_(table_of(device, "tick of observations", Role::upload, std::vector{observe_tick(settings)})),
      agents_(table_of(device, "agents", Role::upload, settings.agents)),
      sensors_(table_of(device, "sensors of agents", Role::upload, settings.sensors)),
      goals_(table_of(device, "goals", Role::upload, std::vector(distances_.size(), ObservedGoal{NAN, NAN}))),
      fresh_(
          table_of(device, "new episodes", Role::upload, std::vector<std::uint32_t>(distances_.size(), kNewEpisode))),
      measures_(table_of(device, "measures", Role::download, std::vector<ObservedMeasure>(distances_.size()))),
      values_(device, "observations", Role::download, gpu::Texel::u32, value_count_),
      groups_(table_of(device, "groups of agents", Role::upload, std::vector<std::uint32_t>(4))),
      kernel_(device, "observations", observe_comp_spv),
      reading_(device) {
  if (!values_.fits_storage_buffer())
    throw base::DeviceError(std::to_string(value_count_) +
                            " observed numbers exceed the storage buffers of the device; use fewer robots or beams");
  kernel_.bind({{"tick", &tick_},
                {"agents", &agents_},
                {"sensors", &sensors_},
                {"goals", &goals_},
                {"fresh", &fresh_},
                {"poses", &fleet.poses()},
                {"motions", &fleet.motions()},
                {"own_states", &fleet.own_states()},
                {"measures", &measures_},
                {"ranges", &ranges},
                {"values", &values_}});
  const ObserveTick tick = observe_tick(settings);
  gpu::write_counts(
      gpu::groups_for(tick.agents * (std::size_t{tick.sensors} * tick.elements + 1), kernel_.group_size()), groups_);
  reading_.begin();
  reading_.end();
}

void DeviceObserver::record(gpu::Batch& batch) {
  batch.barrier();
  batch.dispatch(kernel_, groups_, 0);
  for (const gpu::Buffer* table : {&tick_, &agents_, &sensors_, &goals_, &fresh_, &groups_})
    batch.upload(*table, 0, table->bytes());
}

void DeviceObserver::prepare(gpu::Batch& batch, bool again) {
  tick_.host<ObserveTick>()[0].again = again ? 1 : 0;
  if (!again) std::ranges::fill(fresh_.host<std::uint32_t>(), 0u);  // agents move
  for (const gpu::Buffer* table : {&tick_, &goals_, &fresh_})
    if (again || table == &tick_) batch.upload(*table, 0, table->bytes());
}

void DeviceObserver::set_goals(std::span<const double> goals) {
  SF_CHECK(goals.size() == 2 * distances_.size(), std::to_string(goals.size()) + " numbers");
  std::ranges::copy(goals, goals_.host<double>().begin());
  for (std::uint32_t& fresh : fresh_.host<std::uint32_t>()) fresh |= kNewGoal;
}

void DeviceObserver::restart(std::size_t first, std::size_t end) {
  std::ranges::fill(fresh_.host<std::uint32_t>().subspan(first, end - first), kNewEpisode);
}

void DeviceObserver::read() {
  reading_.download(values_, 0, values_.bytes());
  reading_.download(measures_, 0, measures_.bytes());
  reading_.run();
  const auto measures = measures_.host<ObservedMeasure>();
  for (std::size_t agent = 0; agent < distances_.size(); ++agent) {
    distances_[agent] = std::isnan(measures[agent].distance) ? NAN : measures[agent].distance;
    progress_[agent] = measures[agent].progress;
  }
  const auto failed = [](auto value) { return std::isnan(value); };
  if (std::ranges::any_of(values(), failed) || std::ranges::any_of(progress_, failed))
    throw base::DeviceError("a robot or a beam met more surfaces than this device can test; use the host");
}

}  // namespace sf::robots
