#include "sensors/texture_pyramids.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>

#include "base/srgb.h"

namespace sf::sensors {

namespace {

/// Two neighbouring texels along an axis.
struct Neighbours {
  std::uint32_t low, high;
  float part;  ///< of the higher one, in [0, 1]
};

/// @param c texture coordinate  @param size [px]
Neighbours neighbours_of(double c, world::TextureWrap wrap, std::uint32_t size) {
  const bool repeat = wrap == world::TextureWrap::repeat;
  if (repeat) c -= std::floor(c);
  if (wrap == world::TextureWrap::mirror) c = 1.0 - std::abs(c - 2.0 * std::floor(0.5 * c) - 1.0);
  const double x = std::clamp(c, 0.0, 1.0) * size - 0.5, low = std::floor(x);
  const auto last = static_cast<std::int64_t>(size) - 1, i = static_cast<std::int64_t>(low);
  const std::int64_t before = repeat ? last : 0, after = repeat ? 0 : last;
  return {static_cast<std::uint32_t>(i < 0 ? before : i), static_cast<std::uint32_t>(i < last ? i + 1 : after),
          static_cast<float>(x - low)};
}

/// Calls `visit(i, weight)` for each of `from` texels that meets texel `k` of `to` along the same length.
template <class Visit>
void for_each_covered(std::uint32_t k, std::uint32_t from, std::uint32_t to, const Visit& visit) {
  const std::uint64_t begin = std::uint64_t{k} * from, end = begin + from;  // [1 / (from to)]
  for (std::uint64_t i = begin / to; i * to < end; ++i)
    visit(static_cast<std::uint32_t>(i), static_cast<double>(std::min(end, (i + 1) * to) - std::max(begin, i * to)));
}

}  // namespace

TexturePyramids::TexturePyramids(std::span<const world::Texture> textures) {
  for (std::uint32_t k = 0; k < 256; ++k) linear_[k] = base::linear_color(k).z;
  for (const world::Texture& texture : textures) {
    Level picture{texture.width, texture.height, {}};
    for (std::size_t i = 0; i < texture.rgb.size(); i += 3)
      picture.texels.push_back(std::uint32_t{texture.rgb[i]} << 16 | texture.rgb[i + 1] << 8 | texture.rgb[i + 2]);
    std::vector<Level>& levels = textures_.emplace_back();
    levels.push_back(std::move(picture));
    while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(half_of(levels.back()));
  }
}

/// Returns means over equal rectangles of half of the size, rounded down.
TexturePyramids::Level TexturePyramids::half_of(const Level& from) const {
  Level to{std::max(1u, from.width / 2), std::max(1u, from.height / 2), {}};
  const double all = static_cast<double>(from.width) * from.height;
  for (std::uint32_t y = 0; y < to.height; ++y)
    for (std::uint32_t x = 0; x < to.width; ++x) {
      glm::dvec3 sum{};
      for_each_covered(y, from.height, to.height, [&](std::uint32_t row, double high) {
        for_each_covered(x, from.width, to.width, [&](std::uint32_t column, double wide) {
          sum += high * wide * glm::dvec3(linear(from.texels[std::size_t{row} * from.width + column]));
        });
      });
      to.texels.push_back(base::srgb_color(glm::vec3(sum / all)));
    }
  return to;
}

glm::vec3 TexturePyramids::between_texels(const Level& level, const world::TextureUse& use, glm::dvec2 at) const {
  const Neighbours x = neighbours_of(at.x, use.u, level.width), y = neighbours_of(at.y, use.v, level.height);
  const auto row_at = [&](std::uint32_t row) {
    const std::uint32_t* const texels = &level.texels[std::size_t{row} * level.width];
    return glm::mix(linear(texels[x.low]), linear(texels[x.high]), x.part);
  };
  return glm::mix(row_at(y.low), row_at(y.high), y.part);
}

glm::vec3 TexturePyramids::color_at(const world::TextureUse& use, glm::dvec2 at, const glm::vec3& spread) const {
  const std::vector<Level>& levels = textures_[use.texture];
  const auto width = static_cast<float>(levels[0].width), height = static_cast<float>(levels[0].height);
  const float a = width * width * spread.x, b = width * height * spread.y, c = height * height * spread.z;
  const float middle = 0.5f * (a + c), half = 0.5f * (a - c);
  const float axis = std::sqrt(middle + std::sqrt(half * half + b * b));  // [px] the longer one, from the eigenvalue
  if (axis <= 1.0f) return between_texels(levels[0], use, at);
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(axis), level = (bits >> 23) - 127;
  if (!std::isfinite(axis) || level + 1 >= levels.size()) return between_texels(levels.back(), use, at);
  const float part = std::bit_cast<float>((bits & 0x7FFFFFu) | 0x3F800000u) - 1.0f;  // axis = 2^level (1 + part)
  return glm::mix(between_texels(levels[level], use, at), between_texels(levels[level + 1], use, at), part);
}

}  // namespace sf::sensors
