#pragma once
// Textures of meshes, for cameras with colours.

#include <map>
#include <string>

#include "world/meshes/triangles.h"
#include "world/world.h"

namespace sf::world {

/// Reads the textures of all meshes that have none yet, if a camera of the world has colours; without one, nothing
/// needs them. Adds warnings about those that are left out, whose surfaces have the colour of their material.
/// @param files of meshes that have been read; adds those that it reads again
/// @return whether it added any
bool read_textures(World& world, std::map<std::string, Triangles>& files);

}  // namespace sf::world
