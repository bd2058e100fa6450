#pragma once
// Materials of meshes.

#include <cstdint>
#include <glm/ext/vector_double3.hpp>

namespace sf::world {

inline constexpr double kDefaultReflectance = 0.5;         ///< of models and materials without one, and of the floor
inline constexpr double kMostReflectance = 100.0;          ///< of retroreflectors; diffuse surfaces have at most 1
inline constexpr std::uint32_t kNoMaterial = 0xFFFFFFFFu;  ///< row of faces without a material

/// What a file states about the surfaces of some faces.
struct Material {
  glm::dvec3 color{0.5};                     ///< linear RGB in [0, 1], without textures
  double reflectance = kDefaultReflectance;  ///< as Reflectance::value
};

/// Luminance of a linear colour (Rec. 709), the reflectance of materials that state none.
inline double luminance(const glm::dvec3& color) { return 0.2126 * color.x + 0.7152 * color.y + 0.0722 * color.z; }

}  // namespace sf::world
