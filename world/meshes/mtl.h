#pragma once
// MTL: the materials of OBJ files.

#include <map>
#include <string>
#include <string_view>

#include "world/material.h"

namespace sf::world {

/// Adds the materials of a file's text by name: the colour `Kd`, taken as linear, and its luminance as reflectance
/// unless a texture `map_Kd` replaces it. A later material replaces one with the same name. Other lines are not used.
void read_mtl(std::string_view text, std::map<std::string, Material, std::less<>>& out);

}  // namespace sf::world
