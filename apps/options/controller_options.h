#pragma once
// Controllers and their settings on the command line.

#include <string>
#include <vector>

#include "apps/options/options.h"
#include "control/controllers.h"
#include "scenarios/simulation.h"
#include "world/world.h"

namespace sf::apps {

/// Parses "key=value". The controller that reads the setting determines its type.
control::Setting setting_of(const std::string& text);

/// `--controller` with its `--set`s.
control::ControllerConfig controller_config_of(const ControllerOptions& options);

/// Returns the controllers of all movers. With `--drive`, the named robots have the command line's controller and all
/// others stay at rest. Otherwise each robot has the controller of the world file (`ctrl`), or the command line's if
/// there is none, or if `--controller` was given without `--keep-ctrl`; empty if all robots have the command line's.
/// @throws base::InputError for a name that the world lacks.
std::vector<scenarios::Actor> make_actors(const world::World& world, const RunOptions& options);

/// Names of the controllers, each once, as in "route, convoy".
std::string controllers_of(const std::vector<scenarios::Actor>& actors);

}  // namespace sf::apps
