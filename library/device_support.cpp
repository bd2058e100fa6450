#include "library/device_support.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "control/controllers.h"
#include "control/model_controllers.h"
#include "library/reading_table.h"
#include "sensors/laser.h"
#include "sensors/laser_modes.h"

namespace sf::library {

namespace {

constexpr double kMostYaw = 1e4;  // [rad] a tenth of the largest angle of kernels (robots/device/device_fleet.h)

std::string refused_mover(const world::Mover& mover, bool uses_controllers) {
  if (uses_controllers && !control::controller_of(mover, {}).name.empty())
    return fmt::format("the controller '{}' of '{}' (the option controller \"none\" leaves it out)", mover.controller,
                       mover.name);
  if (mover.random_start.size_spread != glm::dvec3{}) return fmt::format("the random size of '{}'", mover.name);
  if (mover.random_start.slip > 0.0 || mover.random_start.acceleration > 0.0)
    return fmt::format("the random slip or acceleration of '{}'", mover.name);
  return "";
}

std::string refused_sensor(const world::World& world, const sensors::SensorSet& sensor_set) {
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    if (group.type->id != sensors::kLaser) return fmt::format("sensors of type '{}'", group.type->name);
  const sensors::SensorSet::Group* const lasers = sensor_set.group(sensors::kLaser);
  if (lasers == nullptr) return "robots without a laser";
  const auto& settings = sensor_set.settings_of<sensors::CastLaser>(sensors::kLaser);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const sensors::SensorSpec& laser = lasers->rows[i];
    if (laser.elements != lasers->rows.front().elements) return "lasers of different numbers of samples";
    if (settings[i].laser.resolution > 1) return fmt::format("samples of '{}' between its beams", laser.name);
    if (!at_every_tick(laser, world.interval))
      return fmt::format(
          "'{}' with a rate of {:g} Hz, phase of {:g} s and latency of {:g} s (expected {:g} Hz, 0 and 0)", laser.name,
          laser.rate, laser.phase, laser.latency, 1.0 / world.interval);
  }
  return "";
}

}  // namespace

std::string unsupported_option(const sensorfarm::Options& options) {
  const std::pair<bool, const char*> refused[] = {
      {!options.record.empty(), "record"},
      {options.ranks, "ranks"},
      {!options.positioning.empty(), "positioning"},
      {!options.faults.empty(), "faults"},
      {options.caster != "auto", "caster"},
      {!options.controller.empty() && options.controller != "none", "controller"}};
  const auto* const found = std::ranges::find(refused, true, &std::pair<bool, const char*>::first);
  return found == std::end(refused) ? "" : fmt::format("the option '{}'", found->second);
}

std::string unsupported(const world::World& world, const sensors::SensorSet& sensor_set,
                        const sensorfarm::Options& options) {
  if (!control::controlled_models(world).empty()) return "controllers of models that are not robots";
  for (const world::Mover& mover : world.movers)
    if (std::string what = refused_mover(mover, options.controller.empty()); !what.empty()) return what;
  return refused_sensor(world, sensor_set);
}

std::string unsupported(const sensorfarm::WorldStarts& starts) {
  const auto given = [](std::span<const double> values) {
    return std::ranges::any_of(values, [](double value) { return !std::isnan(value); });
  };
  if (std::ranges::any_of(starts.sizes, [](const auto& size) { return !std::isnan(size[0]); }))
    return "starts with sizes";
  if (given(starts.slip) || given(starts.acceleration)) return "starts with slip or acceleration";
  if (std::ranges::any_of(starts.poses, [](const auto& X) { return std::abs(X.yaw) > kMostYaw; }))
    return fmt::format("starts with a yaw beyond {:g} rad", kMostYaw);
  return "";
}

}  // namespace sf::library
