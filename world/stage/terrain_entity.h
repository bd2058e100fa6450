#pragma once
// A height map of the ground: the top-level block `terrain( file "FILE" ... )`.

#include "world/stage/build_state.h"

namespace sf::world {

/// Reads the world's terrain, before models that stand on it.
/// @throws base::InputError for a second terrain, a missing or unsuitable key, and a file that cannot be read
void read_terrain(BuildState& b, const Entity& root);

/// Returns the height [m] of the terrain at `p`; 0 outside and in worlds without a terrain.
double terrain_height(const World& world, glm::dvec2 p);

}  // namespace sf::world
