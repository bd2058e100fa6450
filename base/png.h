#pragma once
// PNG files in memory, through libspng.

#include <cstdint>
#include <span>
#include <string>

namespace sf::base {

/// Figures have uniform areas, for which a search for long matches pays off; pictures of cameras do not, and are
/// compressed in a quarter of the time, into up to half as many bytes again.
enum class PngContent { figure, photograph };

/// Returns the bytes of a PNG file.
/// @param pixels 1 byte (grey) or 3 bytes (red, green, blue) per pixel, row by row, the top row first
/// @param width, height [px] >= 1  @param dpi pixels per inch on paper, stored in the file; 0: not stored
std::string encode_png(std::span<const std::uint8_t> pixels, int width, int height,
                       PngContent content = PngContent::figure, double dpi = 0.0);

/// Returns the bytes of a PNG file with 16 bits per pixel. @param grey row by row, the top row first
std::string encode_png(std::span<const std::uint16_t> grey, int width, int height,
                       PngContent content = PngContent::figure);

}  // namespace sf::base
