#pragma once
// Picture files.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/png.h"

namespace sf::viz {

/// Writes the bytes of a picture. @throws base::InputError if the file cannot be written
void write_picture(const std::string& path, std::string_view bytes);

/// Replaces a picture as a whole: readers see the old or the new one. Writes `path`.part first.
/// @throws base::InputError if the file cannot be written
void replace_picture(const std::string& path, std::string_view bytes);

/// @param rgb 3 bytes per pixel, row by row, the top row first
/// @throws base::InputError if the file cannot be written
void write_png(const std::string& path, std::span<const std::uint8_t> rgb, int width, int height,
               base::PngContent content = base::PngContent::figure);

}  // namespace sf::viz
