#pragma once
// PNG files of figures.

#include <cstdint>
#include <vector>

namespace sf::viz {

/// @param rgb 3 bytes a pixel, row by row, the top row first
/// @return the file; empty when the encoding failed not be encoded
std::vector<std::uint8_t> encode_png(const std::uint8_t* rgb, int width, int height);

}  // namespace sf::viz
