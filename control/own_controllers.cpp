#include "control/own_controllers.h"

#include <fmt/format.h>

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

void check_entry(const sensorfarm::ControllerEntry& entry, const std::string& from) {
  const bool plain = !entry.name.empty() && entry.name.find_first_of(" \t\n/:,=") == std::string::npos;
  if (!plain || entry.name == "none" || base::names_a_plugin(entry.name))
    throw base::InputError(
        from, 0, fmt::format("a controller cannot be called '{}': expected a word without / : , =", entry.name));
  for (const ControllerType* type : controllers())
    if (type->name == entry.name)
      throw base::InputError(from, 0, fmt::format("a controller '{}' already exists; choose another name", entry.name));
  if (!(entry.rate > 0.0 && entry.rate <= 1e4))
    throw base::InputError(from, 0,
                           fmt::format("controller '{}' has a rate of {} Hz: expected more than 0, at most 10000",
                                       entry.name, entry.rate));
  if (!entry.make)
    throw base::InputError(from, 0, fmt::format("controller '{}' has no function that creates it", entry.name));
}

}  // namespace

const ControllerType* add_own_controller(sensorfarm::ControllerEntry entry, const std::string& from) {
  check_entry(entry, from);
  static std::deque<Added> added;
  Added& one = added.emplace_back(Added{std::move(entry), {}});
  one.type = {one.entry.name,     one.entry.summary,   one.entry.rate, one.entry.stops_on_bumper,
              one.entry.on_scans, make_own_controller, &one.entry};
  add_controller(&one.type);
  return &one.type;
}

}  // namespace sf::control
