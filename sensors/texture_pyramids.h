#pragma once
// Textures with smaller versions of each (mip maps: Williams, 1983), filtered in linear light.

#include <array>
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
  using Lanes = float __attribute__((vector_size(16)));  ///< a texel, in one vector instruction each
  using Texel = std::array<std::uint16_t, 4>;            ///< linear red, green and blue, of which 65535 is 1; and 0
  struct Level {
    std::uint32_t width = 0, height = 0;  ///< [px]
    std::vector<Texel> texels;            ///< row by row from the top
  };
  static Level half_of(const Level& level);
  /// @param at within the picture, from (0, 0) to (1, 1)
  static Lanes between_texels(const Level& level, const world::TextureUse& use, glm::dvec2 at);

  std::vector<std::vector<Level>> textures_;  ///< each with the picture first, and one texel last
};

}  // namespace sf::sensors
