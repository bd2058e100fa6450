#pragma once
// Model properties of infrared emitters for robots' infrared receivers (`ir_emitter` and its settings) and of lamps for
// their light sensors (`lamp_intensity`, `lamp_fov`).

#include "world/stage/build_state.h"

namespace sf::world {

/// Adds an emitter if `entity` has one. `model` becomes the next row of the models.
/// @throws base::InputError for an unknown kind, lengths or angles out of range, or an emitter on a mover
void add_emitter(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B);

/// Adds a lamp in the middle of the model's box if `entity` has a `lamp_intensity`. `model` becomes the next row of the
/// models. @throws base::InputError for numbers out of range, more than 1000 lamps, or a lamp on a mover
void add_lamp(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B);

}  // namespace sf::world
