#pragma once
// Colours as 0xAARRGGBB, and colour scales for values in figures. For named colours see viz/theme.h.

#include <cstddef>
#include <cstdint>

namespace sf::viz {

/// @param opacity in [0, 1], replaces the colour's alpha
std::uint32_t with_opacity(std::uint32_t color, double opacity);

/// Interpolates from `a` to `b`, linearly in sRGB, t in [0, 1]. The result is opaque.
std::uint32_t mix(std::uint32_t a, std::uint32_t b, double t);

/// Returns the colour for a value t in [0, 1], from the smallest to the largest. Larger values are lighter, in
/// greyscale print, too.
std::uint32_t scale_color(double t);

/// Coordinates of an opaque colour in OKLab, a space in which equal distances look equally different (Ottosson, "A
/// perceptual color space for image processing", 2020).
struct OklabColor {
  double lightness = 0.0;  ///< in [0, 1]
  double a = 0.0;          ///< green to red
  double b = 0.0;          ///< blue to yellow
};
OklabColor to_oklab(std::uint32_t color);

/// Returns a distinct colour for each `i`. Successive colours differ in hue by the golden angle and in lightness, so
/// that neighbours look different; all contrast with white.
std::uint32_t distinct(std::size_t i);

/// Returns the colour of row `i` of `count`. Up to seven rows use the palette of Okabe and Ito ("Color Universal
/// Design", 2002) without its yellow, which has too little contrast with white. More rows use `distinct`.
std::uint32_t row_color(std::size_t i, std::size_t count);

}  // namespace sf::viz
