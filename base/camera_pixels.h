#pragma once
// Images in readings of cameras, as bytes and as files. A reading has `width` numbers per pixel, row by row from the
// top left: the depth [m], then the colour, 0xRRGGBB, ...

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/echo.h"

namespace sf::base {

/// How the colours of a camera are stored.
struct ColorFormat {
  std::uint32_t columns = 0, rows = 0;  ///< [px]
  bool mono = false;                    ///< grey: red, green and blue are equal, and stored once
  int jpeg = 0;                         ///< quality of JPEG files, in [1, 100]; 0: PNG, which is lossless
};

/// Returns red, green and blue of each pixel. Numbers that are no colour are black. @pre width >= 2
std::vector<std::uint8_t> color_bytes(std::span<const double> reading, std::size_t width);
/// Returns one byte per pixel of a grey camera, or three of another one.
std::vector<std::uint8_t> image_bytes(std::span<const double> reading, std::size_t width, bool mono);
/// Returns the colours as a PNG or JPEG file.
std::string color_file(std::span<const double> reading, std::size_t width, const ColorFormat& format);
/// Returns depths in millimetres, rounded; 0 outside of the limits, and from 65.5355 m.
std::vector<std::uint16_t> millimetre_depths(std::span<const double> reading, std::size_t width,
                                             const RangeLimits& limits);

}  // namespace sf::base
