#pragma once
// Pictures of floor plans and maps as grids of solid and free cells. PNG (all colour types) and Netpbm (P1 to P6) are
// decoded row by row. JPEG, BMP and GIF are decoded by OpenCV, which takes 0.1 s to load: by a plug-in
// (vision/pictures.cpp, `sensorfarm_pictures.so`) that is loaded with the first such picture.

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "world/bitmap.h"

namespace sf::world {

/// One row of a picture. Valid during the call that has it as its argument.
struct PixelRow {
  std::span<const std::uint8_t> rgba;  ///< 4 bytes a pixel; deeper samples are scaled down, alpha 255 is opaque
  bool has_alpha = false;              ///< whether the picture's format stores an alpha
};

/// Sets `solid` for each pixel of a row: 1 solid, 0 free. Called for all rows, from the top.
using SolidRule = std::function<void(const PixelRow& row, std::uint8_t* solid)>;

/// The picture as a grid of its size, 1 to 16384 pixels along each side; the picture's top row is the grid's last.
/// @throws base::InputError when the file is missing, broken, cut short, of another format or too large, or when the
/// plug-in for its format cannot be loaded. Sizes are checked before memory is allocated.
Bitmap read_bitmap(const std::string& file, const SolidRule& rule);

/// The same from memory. @param file name for errors
Bitmap decode_bitmap(const std::string& file, const std::string& bytes, const SolidRule& rule);

/// The plug-in's part of this module.
struct PictureDecoder {
  /// Calls `row` for each row from the top. The picture's header has been checked.
  /// @param file read again for a GIF  @param bytes its content
  /// @return empty, or the reason why the picture cannot be decoded
  std::string (*decode)(const std::string& file, const std::string& bytes, std::uint32_t width, std::uint32_t height,
                        const std::function<void(const PixelRow&)>& row);
};

/// The name of the plug-in's only symbol: `extern "C" const PictureDecoder sensorfarm_pictures`.
inline constexpr const char* kPicturesSymbol = "sensorfarm_pictures";

}  // namespace sf::world
