#pragma once
// Model property of holes in the floor for robots' cliff sensors: `cliff_return 1`.

#include <vector>

#include "world/stage/build_state.h"

namespace sf::world {

/// Returns true if `entity` is a hole in the floor.
bool is_floor_hole(const StageContext& context, const Entity& entity);

/// Adds each closed outline of `shape` as a hole. `model` becomes the next row of the models.
/// @param shape in the body frame
/// @param X_B the body frame in the world
/// @throws base::InputError for a hole on a mover, a bitmap, or a self-crossing outline
void add_floor_holes(BuildState& b, const Entity& entity, const Model& model, const std::vector<Segment>& shape,
                     const Pose& X_B);

}  // namespace sf::world
