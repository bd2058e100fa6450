#pragma once
// Colours: linear light and its 8-bit values in sRGB (IEC 61966-2-1).

#include <cstdint>
#include <glm/ext/vector_float3.hpp>

namespace sf::base {

/// Linear red, green and blue in [0, 1] of 0xAARRGGBB.
glm::vec3 linear_color(std::uint32_t color);

/// Returns 0xRRGGBB of linear light: clamped to [0, 1], and rounded exactly. NaN is 0.
std::uint32_t srgb_color(glm::vec3 light);

}  // namespace sf::base
