#include "control/own_controllers.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "base/error.h"
#include "base/installation.h"
#include "control/own_controller.h"

namespace sf::control {

namespace {

/// An entry and its row in the list of controllers, at one address for the rest of the program.
struct Added {
  sensorfarm::ControllerEntry entry;
  ControllerType type;
};

std::deque<sensorfarm::ModelEntry>& own_models() {
  static std::deque<sensorfarm::ModelEntry> entries;
  return entries;
}

void check_entry(const std::string& name, bool can_make, const std::string& from) {
  const bool plain = !name.empty() && name.find_first_of(" \t\n/:,=") == std::string::npos;
  if (!plain || name == "none" || base::names_a_plugin(name))
    throw base::InputError(from, 0,
                           fmt::format("a controller cannot be called '{}': expected a word without / : , =", name));
  const auto is_taken = [&](const auto& names) { return std::find(names.begin(), names.end(), name) != names.end(); };
  if (is_taken(controller_names()) || is_taken(model_controller_names()))
    throw base::InputError(from, 0, fmt::format("a controller '{}' already exists; choose another name", name));
  if (!can_make) throw base::InputError(from, 0, fmt::format("controller '{}' has no function that creates it", name));
}

}  // namespace

const ControllerType* add_own_controller(sensorfarm::ControllerEntry entry, const std::string& from) {
  check_entry(entry.name, static_cast<bool>(entry.make), from);
  if (!(entry.rate > 0.0 && entry.rate <= 1e4))
    throw base::InputError(from, 0,
                           fmt::format("controller '{}' has a rate of {} Hz: expected more than 0, at most 10000",
                                       entry.name, entry.rate));
  static std::deque<Added> added;
  Added& one = added.emplace_back(Added{std::move(entry), {}});
  one.type = {one.entry.name,     one.entry.summary,   one.entry.rate, one.entry.stops_on_bumper,
              one.entry.on_scans, make_own_controller, &one.entry};
  add_controller(&one.type);
  return &one.type;
}

const sensorfarm::ModelEntry* add_own_model_controller(sensorfarm::ModelEntry entry, const std::string& from) {
  check_entry(entry.name, static_cast<bool>(entry.make), from);
  return &own_models().emplace_back(std::move(entry));
}

const std::deque<sensorfarm::ModelEntry>& model_controllers() { return own_models(); }

std::vector<std::string_view> model_controller_names() {
  std::vector<std::string_view> names;
  for (const sensorfarm::ModelEntry& entry : own_models()) names.emplace_back(entry.name);
  return names;
}

}  // namespace sf::control
