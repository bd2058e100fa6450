#pragma once
// Controllers and their settings from the command line.

#include <string>
#include <vector>

#include "apps/options.h"
#include "control/controllers.h"
#include "scenarios/simulation.h"
#include "world/world.h"

namespace sf::apps {

/// "key=value" as a setting, whose type is what it is read as.
control::Setting setting_of(const std::string& text);

/// `--controller` with its `--set`s.
control::ControllerConfig controller_config_of(const ControllerOptions& options);

/// The plan for whom `--drive` names, all others stand. Where it names nobody every robot is driven, by what its world
/// file says first (`ctrl`); empty where that is the same for all.
/// @throws base::InputError for a name that the world lacks.
std::vector<scenarios::Actor> make_actors(const world::World& world, const RunOptions& options);

}  // namespace sf::apps
