#pragma once
// Textures with smaller versions of each (mip maps: Williams, 1983), filtered in linear light.

#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <glm/ext/vector_float3.hpp>
#include <span>
#include <vector>

#include "world/world.h"

namespace sf::sensors {

/// Immutable once built; any number of threads may read it.
class TexturePyramids {
 public:
  TexturePyramids() = default;
  explicit TexturePyramids(std::span<const world::Texture> textures);

  /// Returns the linear colour of a footprint: between the two levels whose texels are nearest to its longer axis in
  /// size, and in each between the four texels around `at`. Where a texel is larger, it is that of the picture itself.
  /// @param at finite texture coordinates (world::MeshTextures)
  /// @param spread squares and product (uu, uv, vv) of the footprint's size in texture coordinates; NaN: without end
  glm::vec3 color_at(const world::TextureUse& use, glm::dvec2 at, const glm::vec3& spread) const;

 private:
  struct Level {
    std::uint32_t width = 0, height = 0;  ///< [px]
    std::vector<std::uint32_t> texels;    ///< 0xRRGGBB in sRGB, row by row from the top
  };
  glm::vec3 linear(std::uint32_t texel) const {
    return {linear_[texel >> 16], linear_[texel >> 8 & 255], linear_[texel & 255]};
  }
  Level half_of(const Level& level) const;
  glm::vec3 between_texels(const Level& level, const world::TextureUse& use, glm::dvec2 at) const;

  std::vector<std::vector<Level>> textures_;  ///< each with the picture first, and one texel last
  float linear_[256] = {};                    ///< light of 8-bit values
};

}  // namespace sf::sensors
