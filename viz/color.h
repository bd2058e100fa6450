#pragma once
// Colours as 0xAARRGGBB, and the scales of values of figures; all named colours: viz/theme.h.

#include <cstddef>
#include <cstdint>

namespace sf::viz {

/// @param opacity in [0, 1], replaces the colour's own
std::uint32_t with_opacity(std::uint32_t color, double opacity);

/// The opaque colour `t` of the way from `a` to `b`, t in [0, 1], evenly in sRGB.
std::uint32_t mix(std::uint32_t a, std::uint32_t b, double t);

/// The colour of a value, t in [0, 1] from the least to the greatest. Greater values are lighter, in grey print too.
std::uint32_t scale_color(double t);

/// Coordinates of an opaque colour in OKLab, in which equal distances look equally different (Ottosson, "A perceptual
/// color space for image processing", 2020).
struct OklabColor {
  double lightness = 0.0;  ///< in [0, 1]
  double a = 0.0;          ///< green to red
  double b = 0.0;          ///< blue to yellow
};
OklabColor to_oklab(std::uint32_t color);

/// A colour of its own for each `i`: successive ones differ in hue by the golden angle and in lightness, so that
/// neighbours look unlike each other; all contrast with white.
std::uint32_t distinct(std::size_t i);

/// The colour of row `i` of `count`. Up to seven rows: the palette of Okabe and Ito ("Color Universal Design", 2002)
/// without its yellow, which has no contrast with white. More rows: `distinct`.
std::uint32_t row_color(std::size_t i, std::size_t count);

}  // namespace sf::viz
