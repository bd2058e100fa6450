#pragma once
// Models whose body is a file of outlines (`outlines "FILE"`).

#include "world/stage/build_state.h"

namespace sf::world {

/// Adds the file to `World::unread`. `model` becomes the next row of the models.
/// @param surface model and flags of the walls
/// @param height [m] of outlines without a height in the file
/// @param X_B the body frame in the world
/// @throws base::InputError if there is no such file, and for a model that moves, is a hole or has another body
void add_outlines(BuildState& b, const Entity& entity, const Model& model, Segment surface, double height,
                  const Pose& X_B);

}  // namespace sf::world
