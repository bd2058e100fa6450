#pragma once
// MTL: the materials of OBJ files.

#include <glm/ext/vector_float2.hpp>
#include <map>
#include <string>
#include <string_view>

#include "world/material.h"

namespace sf::world {

struct MtlMaterial : Material {
  std::string texture;                  ///< file of `map_Kd`, as written; empty: none
  bool clamp = false, alpha = false;    ///< `-clamp on`; `map_d`
  glm::vec2 scale{1.0f}, offset{0.0f};  ///< `-s`, `-o`, of the texture coordinates
};

/// Adds the materials of a file's text by name: the colour `Kd`, taken as linear, and its luminance as reflectance,
/// or a texture `map_Kd`, whose colour they multiply, 1 without `Kd`. A later material replaces one with the same name.
/// Other lines are not used.
void read_mtl(std::string_view text, std::map<std::string, MtlMaterial, std::less<>>& out);

}  // namespace sf::world
