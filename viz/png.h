#pragma once
// PNG files of figures, and writing of picture files in general.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sf::viz {

/// Figures have uniform areas, for which a search for long matches pays off; photographs do not.
enum class PngContent { figure, photograph };

/// Returns the bytes of a PNG file.
/// @param rgb 3 bytes per pixel, row by row, the top row first
/// @param dpi pixels per inch on paper, stored in the file; 0: not stored
std::string encode_png(std::span<const std::uint8_t> rgb, int width, int height,
                       PngContent content = PngContent::figure, double dpi = 0.0);

/// Returns the bytes of a PNG file with 16 bits per pixel. @param grey row by row, the top row first
std::string encode_grey_png(std::span<const std::uint16_t> grey, int width, int height);

/// Writes the bytes of a picture. @throws base::InputError if the file cannot be written
void write_picture(const std::string& path, std::string_view bytes);

/// Replaces a picture as a whole: readers see the old or the new one. Writes `path`.part first.
/// @throws base::InputError if the file cannot be written
void replace_picture(const std::string& path, std::string_view bytes);

/// @throws base::InputError if the file cannot be written
void write_png(const std::string& path, std::span<const std::uint8_t> rgb, int width, int height,
               PngContent content = PngContent::figure);

}  // namespace sf::viz
