#pragma once
// Models whose surface is a mesh (`mesh "FILE"`), for spatial sensors.

#include <optional>

#include "world/stage/build_state.h"

namespace sf::world {

/// Returns the row in `World::meshes` of the entity's mesh, in its body frame: fitted into the box of `size` if the
/// entity has one, else in the file's own frame, times `mesh_scale`; turned by `mesh_rotation` before. Models with one
/// file and equal properties share a row.
/// @param size in/out: without `size`, becomes that of the mesh
std::optional<std::uint32_t> mesh_of(BuildState& b, const Entity& entity, Size& size);

/// Adds the mesh of the model that is about to be appended, unless lasers do not see it.
void add_mesh(BuildState& b, std::uint32_t mesh, const Segment& surface, const Pose& X_B);

}  // namespace sf::world
