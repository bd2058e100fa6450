#pragma once
// JPEG files in memory, through libjpeg-turbo.

#include <cstdint>
#include <span>
#include <string>

namespace sf::base {

inline constexpr int kJpegQuality = 95;  ///< that of ROS 2's image_transport

/// Returns the bytes of a baseline JPEG file: grey, or luminance and colour differences at half the resolution (4:2:0).
/// They are equal on all processors, as libjpeg-turbo's vector instructions are exact to the bit with its integer
/// transform. The error of a pixel has no bound.
/// @param pixels 1 byte (grey) or 3 bytes (red, green, blue) per pixel, row by row, the top row first
/// @param width, height [px] in [1, 65500]  @param quality in [1, 100], as of cjpeg
std::string encode_jpeg(std::span<const std::uint8_t> pixels, int width, int height, int quality = kJpegQuality);

}  // namespace sf::base
