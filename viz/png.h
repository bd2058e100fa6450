#pragma once
// PNG files of figures.

#include <cstdint>
#include <string>

namespace sf::viz {

/// Figures, whose areas of one colour repay the search for long matches, or photographs, which do not.
enum class PngContent { figure, photograph };

/// @param rgb 3 bytes a pixel, row by row, the top row first
/// @throws base::InputError when the file cannot be written
void write_png(const std::string& path, const std::uint8_t* rgb, int width, int height,
               PngContent content = PngContent::figure);

}  // namespace sf::viz
