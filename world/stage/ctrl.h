#pragma once
// `ctrl "NAME KEY=VALUE ..."`: the controller of one robot.

#include <string>

#include "world/stage/build_state.h"

namespace sf::world {

/// Reads `ctrl` into the fields of the mover (`controller`, `controller_settings`, `controller_at`). A file's name is
/// relative to the folder of the world file that contains it. Loads no code. Warns about plug-ins of Stage, unknown
/// names, words that are not KEY=VALUE, and further controllers; such a robot is driven as without `ctrl`.
void read_ctrl(BuildState& b, const Entity& entity, Mover& mover);

}  // namespace sf::world
