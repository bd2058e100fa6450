#include "control/controllers.h"

#include <fmt/format.h>

#include <vector>

#include "base/error.h"

namespace sf::control {

// Every kind, in the order of help.
extern const ControllerKind wander_controller;

std::span<const ControllerKind* const> controllers() {
  static constexpr const ControllerKind* kKinds[] = {&wander_controller};
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
  Made made{kind->make(site, plan.settings), plan.rate > 0.0 ? plan.rate : kind->rate};
  plan.settings.require_all_read();
  return made;
}

}  // namespace sf::control
