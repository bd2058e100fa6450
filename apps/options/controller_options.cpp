#include "apps/options/controller_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "apps/options/option_parsers.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"

namespace sf::apps {

control::Setting setting_of(const std::string& text) {
  const auto [key, value] = *read_setting(text);
  return {key, control::RawText{value}, fmt::format("--set {}: ", key)};
}

control::ControllerConfig controller_config_of(const ControllerOptions& options) {
  std::vector<control::Setting> settings;
  for (const std::string& text : options.set) settings.push_back(setting_of(text));
  if (options.localize) settings.push_back({"localize", *options.localize, "--localize: "});
  return {options.controller, 0.0,
          control::Settings(fmt::format("controller '{}'", options.controller), std::move(settings))};
}

namespace {

/// Returns whether the world file gives the robot a controller other than the command line's.
bool has_own(const world::Mover& mover, const RunOptions& options) {
  return !mover.is_tag && !mover.controller.empty() &&
         (mover.controller != options.controller || !mover.controller_settings.empty());
}

/// Empty if all robots use the command line's controller.
std::vector<scenarios::Actor> actors_of_world(const world::World& world, const RunOptions& options) {
  const auto count = std::count_if(world.movers.begin(), world.movers.end(),
                                   [&](const world::Mover& mover) { return has_own(mover, options); });
  if (count == 0) return {};
  if (options.controller_given && !options.keep_ctrl) {
    print_message("--controller {} overrides the controller in the world file (ctrl) of {}; --keep-ctrl keeps it",
                  options.controller, count == 1 ? "1 robot" : fmt::format("{} robots", count));
    return {};
  }
  print_message("{} driven by the controller in the world file (ctrl); use --drive NAME to drive a robot by '{}'",
                count == 1 ? "1 robot is" : fmt::format("{} robots are", count), options.controller);
  std::vector<scenarios::Actor> actors;
  for (const world::Mover& mover : world.movers) {
    actors.push_back({.controller = control::controller_of(mover, controller_config_of(options))});
    // The shell then leaves the true states in place.
    if (!options.localize.value_or(true)) actors.back().controller.localized_outside = true;
  }
  return actors;
}

}  // namespace

std::vector<scenarios::Actor> make_actors(const world::World& world, const RunOptions& options) {
  if (options.drive.empty()) return actors_of_world(world, options);
  std::vector<std::string_view> names;
  for (const world::Mover& mover : world.movers) names.emplace_back(mover.name);
  std::vector<scenarios::Actor> actors(world.movers.size(), {.controller = {.name = ""}});
  for (const std::string& name : options.drive) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) refuse_robot(world, name, names);
    actors[static_cast<std::size_t>(found - names.begin())].controller = controller_config_of(options);
  }
  return actors;
}

std::string controllers_of(const std::vector<scenarios::Actor>& actors) {
  std::vector<std::string> names;
  for (const scenarios::Actor& actor : actors) {
    const std::string& name = actor.controller.name;
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace sf::apps
