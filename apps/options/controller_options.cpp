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
  if (options.localize) settings.push_back({"localize", true, "--localize: "});
  return {options.controller, 0.0,
          control::Settings(fmt::format("controller '{}'", options.controller), std::move(settings))};
}

namespace {

/// Robots with a controller in the world file use that one; all others use the command line's. Empty if all robots use
/// the command line's.
std::vector<scenarios::Actor> actors_of_world(const world::World& world, const RunOptions& options) {
  const auto own = [&](const world::Mover& mover) {
    return !mover.is_tag && !mover.controller.empty() && mover.controller != options.controller;
  };
  const auto count = std::count_if(world.movers.begin(), world.movers.end(), own);
  if (count == 0) return {};
  print_message("{} driven by the controller in the world file (ctrl); use --drive NAME to drive a robot by '{}'",
                count == 1 ? "1 robot is" : fmt::format("{} robots are", count), options.controller);
  std::vector<scenarios::Actor> actors;
  for (const world::Mover& mover : world.movers)
    actors.push_back({.controller = mover.is_tag ? control::ControllerConfig{}
                                    : own(mover) ? control::ControllerConfig{.name = mover.controller}
                                                 : controller_config_of(options)});
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

}  // namespace sf::apps
