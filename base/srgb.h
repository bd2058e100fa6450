#pragma once
// Colours: linear light and its 8-bit values in sRGB (IEC 61966-2-1).

#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <glm/ext/vector_float3.hpp>
#include <span>

namespace sf::base {

/// Weights of linear red, green and blue in the luminance (Rec. 709).
inline constexpr glm::dvec3 kLuminance{0.2126, 0.7152, 0.0722};

/// Linear red, green and blue in [0, 1] of 0xAARRGGBB.
glm::vec3 linear_color(std::uint32_t color);

/// Returns 0xRRGGBB of linear light: clamped to [0, 1], and rounded exactly. NaN is 0.
std::uint32_t srgb_color(glm::vec3 light);
/// Returns 0xRRGGBB with bytes in proportion to the light, of which 1 is 255: clamped, and rounded. NaN is 0.
std::uint32_t linear_bytes(glm::vec3 light);
/// Returns the colours of srgb_color of as many lights as `out` has colours, fast where neighbours are equal.
void srgb_colors(const float* red, const float* green, const float* blue, std::span<std::uint32_t> out);

}  // namespace sf::base
