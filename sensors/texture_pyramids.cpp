#include "sensors/texture_pyramids.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/srgb.h"

namespace sf::sensors {

namespace {

/// Two neighbouring texels along an axis.
struct Neighbours {
  std::uint32_t low, high;
  float part;  ///< of the higher one, in [0, 1]
};

/// Rounds down: faster than std::floor, which calls a function. @param x within 2^62
std::int64_t floor_of(double x) {
  const auto i = static_cast<std::int64_t>(x);
  return i - (static_cast<double>(i) > x ? 1 : 0);
}

/// Returns the place in the picture, in [0, 1], that a texture coordinate shows.
double place_of(double c, world::TextureWrap wrap) {
  if (wrap != world::TextureWrap::clamp && std::abs(c) < 1e15) {
    if (wrap == world::TextureWrap::repeat) return c - static_cast<double>(floor_of(c));
    return 1.0 - std::abs(c - 2.0 * static_cast<double>(floor_of(0.5 * c)) - 1.0);
  }
  return c > 0.0 ? std::min(c, 1.0) : 0.0;
}

/// @param c of place_of  @param size [px]
Neighbours neighbours_of(double c, world::TextureWrap wrap, std::uint32_t size) {
  const double x = c * size - 0.5;
  const auto i = static_cast<std::int32_t>(floor_of(x)), last = static_cast<std::int32_t>(size) - 1;
  const bool repeat = wrap == world::TextureWrap::repeat;
  return {static_cast<std::uint32_t>(i >= 0   ? i
                                     : repeat ? last
                                              : 0),
          static_cast<std::uint32_t>(i < last ? i + 1
                                     : repeat ? 0
                                              : last),
          static_cast<float>(x - i)};
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
  std::uint16_t linear[256];
  for (std::uint32_t k = 0; k < 256; ++k)
    linear[k] = static_cast<std::uint16_t>(base::linear_color(k).z * 65535.0f + 0.5f);
  for (const world::Texture& texture : textures) {
    Level picture{texture.width, texture.height, {}};
    for (std::size_t i = 0; i < texture.rgb.size(); i += 3)
      picture.texels.push_back({linear[texture.rgb[i]], linear[texture.rgb[i + 1]], linear[texture.rgb[i + 2]], 0});
    std::vector<Level>& levels = textures_.emplace_back();
    levels.push_back(std::move(picture));
    while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(half_of(levels.back()));
  }
}

/// Returns means over equal rectangles of half of the size, rounded down.
TexturePyramids::Level TexturePyramids::half_of(const Level& from) {
  Level to{std::max(1u, from.width / 2), std::max(1u, from.height / 2), {}};
  const double all = static_cast<double>(from.width) * from.height;
  for (std::uint32_t y = 0; y < to.height; ++y)
    for (std::uint32_t x = 0; x < to.width; ++x) {
      double sum[3] = {};
      for_each_covered(y, from.height, to.height, [&](std::uint32_t row, double high) {
        for_each_covered(x, from.width, to.width, [&](std::uint32_t column, double wide) {
          const Texel& texel = from.texels[std::size_t{row} * from.width + column];
          for (std::size_t c = 0; c < 3; ++c) sum[c] += high * wide * texel[c];
        });
      });
      Texel& mean = to.texels.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) mean[c] = static_cast<std::uint16_t>(sum[c] / all + 0.5);
    }
  return to;
}

TexturePyramids::Lanes TexturePyramids::between_texels(const Level& level, const world::TextureUse& use,
                                                       glm::dvec2 at) {
  const Neighbours x = neighbours_of(at.x, use.u, level.width), y = neighbours_of(at.y, use.v, level.height);
  const auto texel_at = [&](std::uint32_t row, std::uint32_t column) {
    const Texel& texel = level.texels[std::size_t{row} * level.width + column];
    using Whole = std::int32_t __attribute__((vector_size(16)));
    return __builtin_convertvector((Whole{texel[0], texel[1], texel[2], texel[3]}), Lanes);
  };
  const auto row_at = [&](std::uint32_t row) {
    const Lanes low = texel_at(row, x.low);
    return low + (texel_at(row, x.high) - low) * x.part;
  };
  const Lanes low = row_at(y.low);
  return low + (row_at(y.high) - low) * y.part;
}

glm::vec3 TexturePyramids::color_at(const world::TextureUse& use, glm::dvec2 at, const glm::vec3& spread) const {
  const std::vector<Level>& levels = textures_[use.texture];
  at = {place_of(at.x, use.u), place_of(at.y, use.v)};
  const auto width = static_cast<float>(levels[0].width), height = static_cast<float>(levels[0].height);
  const float a = width * width * spread.x, b = width * height * spread.y, c = height * height * spread.z;
  const float middle = 0.5f * (a + c), half = 0.5f * (a - c);
  const float axis = std::sqrt(middle + std::sqrt(half * half + b * b));  // [px] the longer one, from the eigenvalue
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(axis), exponent = (bits >> 23) - 127;
  const bool is_coarsest = !std::isfinite(axis) || (axis > 1.0f && exponent + 1 >= levels.size());
  const std::size_t level = is_coarsest ? levels.size() - 1 : axis <= 1.0f ? 0 : exponent;
  Lanes color = between_texels(levels[level], use, at);
  if (!is_coarsest && axis > 1.0f) {
    const float part = std::bit_cast<float>((bits & 0x7FFFFFu) | 0x3F800000u) - 1.0f;  // axis = 2^level (1 + part)
    color += (between_texels(levels[level + 1], use, at) - color) * part;
  }
  color *= 1.0f / 65535.0f;
  return {color[0], color[1], color[2]};
}

}  // namespace sf::sensors
