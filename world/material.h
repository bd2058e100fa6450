#pragma once
// Materials of meshes, and their textures.

#include <cstddef>
#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <glm/geometric.hpp>

#include "base/srgb.h"

namespace sf::world {

inline constexpr double kDefaultReflectance = 0.5;         ///< of models and materials without one, and of the floor
inline constexpr double kMostReflectance = 100.0;          ///< of retroreflectors; diffuse surfaces have at most 1
inline constexpr std::uint32_t kNoMaterial = 0xFFFFFFFFu;  ///< row of faces without a material
inline constexpr std::uint32_t kNoTexture = 0xFFFFFFFFu;   ///< row of materials without a texture
inline constexpr std::uint32_t kMostTextureSide = 8192;    ///< [px]
inline constexpr std::size_t kMostTexels = 1u << 26;       ///< of all textures of a world
inline constexpr float kMostTextureCoordinate = 1e6f;

/// What a file states about the surfaces of some faces.
struct Material {
  glm::dvec3 color{0.5};                     ///< linear RGB in [0, 1]; multiplies that of a texture
  double reflectance = kDefaultReflectance;  ///< as Reflectance::value
};

/// How a texture continues beyond its picture, along one of its axes.
enum class TextureWrap : std::uint8_t { repeat, clamp, mirror };

/// The texture of a material.
struct TextureUse {
  std::uint32_t texture = kNoTexture;  ///< row in a table of textures
  TextureWrap u = TextureWrap::repeat, v = TextureWrap::repeat;
};

/// Luminance of a linear colour (Rec. 709), the reflectance of materials that state none.
inline double luminance(const glm::dvec3& color) { return glm::dot(base::kLuminance, color); }

}  // namespace sf::world
