#pragma once
// Controllers and their settings from the command line.

#include <string>
#include <vector>

#include "apps/options/options.h"
#include "control/controllers.h"
#include "scenarios/simulation.h"
#include "world/world.h"

namespace sf::apps {

/// "key=value" as a setting; the controller that reads it determines its type.
control::Setting setting_of(const std::string& text);

/// `--controller` with its `--set`s.
control::ControllerConfig controller_config_of(const ControllerOptions& options);

/// Controllers of all movers. With `--drive` the robots that it names have the command line's, and all others stand.
/// Without it each robot has the controller of the world file (`ctrl`), or else the command line's; empty where all
/// have the same.
/// @throws base::InputError for a name that the world lacks.
std::vector<scenarios::Actor> make_actors(const world::World& world, const RunOptions& options);

}  // namespace sf::apps
