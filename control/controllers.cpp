#include "control/controllers.h"

#include <fmt/format.h>

#include <vector>

#include "base/error.h"
#include "control/shell.h"

namespace sf::control {

// Every kind, in the order of help.
extern const ControllerKind avoid_controller;
extern const ControllerKind convoy_controller;
extern const ControllerKind docking_controller;
extern const ControllerKind explore_controller;
extern const ControllerKind lane_keeping_controller;
extern const ControllerKind magnet_keeping_controller;
extern const ControllerKind patrol_controller;
extern const ControllerKind route_controller;
extern const ControllerKind wander_controller;

std::span<const ControllerKind* const> controllers() {
  static constexpr const ControllerKind* kKinds[] = {
      &avoid_controller,   &convoy_controller,       &docking_controller,
      &explore_controller, &lane_keeping_controller, &magnet_keeping_controller,
      &patrol_controller,  &route_controller,        &wander_controller,
  };
  return kKinds;
}

const ControllerKind* find_controller(std::string_view name) {
  for (const ControllerKind* kind : controllers())
    if (kind->name == name) return kind;
  return nullptr;
}

Made make_controller(const Site& site, Plan plan) {
  const ControllerKind* kind = find_controller(plan.controller);
  if (kind == nullptr) {
    std::vector<std::string_view> names;
    for (const ControllerKind* known : controllers()) names.push_back(known->name);
    throw base::InputError(
        fmt::format("there is no controller '{}'; expected one of: {}", plan.controller, fmt::join(names, ", ")));
  }
  const ShellSettings shell = read_shell_settings(plan.settings, kind->waits);
  std::unique_ptr<Controller> inner = kind->make(site, plan.settings);
  plan.settings.require_all_read();
  return {std::make_unique<Shell>(std::move(inner), shell), plan.rate > 0.0 ? plan.rate : kind->rate};
}

}  // namespace sf::control
