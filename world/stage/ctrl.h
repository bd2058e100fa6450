#pragma once
// `ctrl "NAME KEY=VALUE ..."`: the controller of one robot, or of a model that is not a robot. `dynamics "NAME
// KEY=VALUE
// ..."`: how a robot moves.

#include <string>

#include "world/stage/build_state.h"

namespace sf::world {

/// Returns whether `ctrl` names a controller for a model that is not a robot: one of LoadOptions::model_controllers, or
/// a file of code, which may have one.
bool names_model_controller(const BuildState& b, const Entity& entity);

/// Warns that a model that is not a robot ignores `ctrl`, if it has one that is not "none".
void warn_of_ctrl(BuildState& b, const Entity& entity, const std::string& model);

/// Reads `ctrl` into the fields of the mover (`controller`, `controller_settings`, `controller_at`). A file's name is
/// relative to the folder of the world file that contains it. Loads no code. Warns about plug-ins of Stage, unknown
/// names, words that are not KEY=VALUE, and further controllers; such a robot is driven as without `ctrl`. Movers that
/// are not robots accept controllers of models only.
void read_ctrl(BuildState& b, const Entity& entity, Mover& mover);

/// Reads `dynamics` into the mover. Loads no code. @throws base::InputError for a name that is neither "car" nor a
/// file, words that are not KEY=VALUE, repeated keys, and objects that are not robots
void read_dynamics(BuildState& b, const Entity& entity, Mover& mover);

}  // namespace sf::world
