#pragma once
// PNG files of figures, and the files of pictures in general.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sf::viz {

/// Figures, whose areas of one colour repay the search for long matches, or photographs, which do not.
enum class PngContent { figure, photograph };

/// The bytes of a PNG file.
/// @param rgb 3 bytes a pixel, row by row, the top row first
/// @param dpi pixels per inch on paper, stated in the file; 0: not stated
std::string encode_png(std::span<const std::uint8_t> rgb, int width, int height,
                       PngContent content = PngContent::figure, double dpi = 0.0);

/// Writes the bytes of a picture. @throws base::InputError when the file cannot be written
void write_picture(const std::string& path, std::string_view bytes);

/// @throws base::InputError when the file cannot be written
void write_png(const std::string& path, std::span<const std::uint8_t> rgb, int width, int height,
               PngContent content = PngContent::figure);

}  // namespace sf::viz
