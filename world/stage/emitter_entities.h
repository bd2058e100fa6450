#pragma once
// Model properties of infrared emitters for robots' infrared receivers: `ir_emitter` and its settings.

#include "world/stage/build_state.h"

namespace sf::world {

/// Adds an emitter if `entity` has one. `model` becomes the next row of the models.
/// @throws base::InputError for an unknown kind, lengths or angles out of range, or an emitter on a mover
void add_emitter(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B);

}  // namespace sf::world
