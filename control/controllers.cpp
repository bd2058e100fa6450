#include "control/controllers.h"

#include <fmt/format.h>

#include <vector>

#include "base/error.h"
#include "base/installation.h"
#include "base/suggest.h"
#include "control/control_shell.h"
#include "control/own_controllers.h"
#include "sensors/laser_settings.h"

namespace sf::control {

// All controllers, in the order of the help text.
extern const ControllerType avoid_controller;
extern const ControllerType convoy_controller;
extern const ControllerType cruise_controller;
extern const ControllerType docking_controller;
extern const ControllerType explore_controller;
extern const ControllerType lane_camera_controller;
extern const ControllerType lane_keeping_controller;
extern const ControllerType magnet_keeping_controller;
extern const ControllerType patrol_controller;
extern const ControllerType remote_controller;
extern const ControllerType route_controller;
extern const ControllerType wander_controller;

namespace {

std::vector<const ControllerType*>& all() {
  static std::vector<const ControllerType*> types{
      &avoid_controller,   &convoy_controller,      &cruise_controller,       &docking_controller,
      &explore_controller, &lane_camera_controller, &lane_keeping_controller, &magnet_keeping_controller,
      &patrol_controller,  &remote_controller,      &route_controller,        &wander_controller,
  };
  return types;
}

}  // namespace

std::span<const ControllerType* const> controllers() { return all(); }

void add_controller(const ControllerType* type) { all().push_back(type); }

const ControllerType* find_controller(std::string_view name) {
  if (base::names_a_plugin(name)) return load_controller(std::string(name));
  for (const ControllerType* type : controllers())
    if (type->name == name) return type;
  return nullptr;
}

std::vector<std::string_view> controller_names() {
  std::vector<std::string_view> names;
  for (const ControllerType* type : controllers()) names.push_back(type->name);
  return names;
}

Settings settings_of_ctrl(const world::Mover& mover) {
  std::vector<Setting> settings;
  for (const auto& [key, value] : mover.controller_settings)
    settings.push_back({key, RawText{value}, mover.controller_at});
  return {fmt::format("controller '{}'", mover.controller), std::move(settings)};
}

ControllerConfig controller_of(const world::Mover& mover, const ControllerConfig& fallback) {
  if (mover.is_tag || mover.controller == "none") return {};
  if (mover.controller.empty()) return fallback;
  if (mover.controller == fallback.name && mover.controller_settings.empty()) return fallback;
  return {.name = mover.controller, .settings = settings_of_ctrl(mover), .at = mover.controller_at};
}

std::vector<sensors::SensorSpec> ControllerContext::sensors_of(std::uint8_t sensor_type) const {
  std::optional<sensors::SensorSet> made;
  const auto specs = sensors_or(made).of(sensor_type, mover);
  return {specs.begin(), specs.end()};
}

namespace {

ConfiguredController make(const ControllerContext& context, ControllerConfig config) {
  const ControllerType* type = find_controller(config.name);
  if (type == nullptr) {
    throw base::InputError(fmt::format("there is no controller '{}'{}", config.name,
                                       base::expected_one_of(config.name, controller_names())));
  }
  const ControlShellSettings shell = read_control_shell_settings(config.settings, type->stops_on_bumper);
  ControllerContext own = context;
  own.type = type;
  std::unique_ptr<Controller> inner = type->make(own, config.settings);
  config.settings.require_all_read();
  const world::Mover& mover = context.world.movers[context.mover];
  const bool on_scans = type->on_scans && config.rate == 0.0 && sensors::has_laser(mover);
  std::optional<OwnLocalization> localization;
  const bool localizes = shell.localize.value_or(can_localize(mover)) && !config.localized_outside;
  if (localizes) localization.emplace(mover, config.known_start, shell.monitor);
  if (shell.monitor && !localizes)
    throw base::InputError("'monitor' is for robots that localize themselves by their own sensors in a run; '" +
                           mover.name + "' does not");
  return {std::make_unique<ControlShell>(std::move(inner), shell, std::move(localization)),
          config.rate > 0.0 ? config.rate : type->rate, on_scans, shell.localize};
}

}  // namespace

ConfiguredController make_controller(const ControllerContext& context, ControllerConfig config) {
  const std::string at = config.at;
  return with_place(at, [&] { return make(context, std::move(config)); });
}

}  // namespace sf::control
