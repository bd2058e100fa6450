#pragma once
// Reads pictures: those of floor plans and maps as grids of solid and free cells, and textures. PNG (all colour types)
// and Netpbm (P1 to P6) are decoded row by row. JPEG, BMP and GIF are decoded by OpenCV, which takes 0.1 s to load, so
// it is in a plug-in (vision/pictures.cpp, `sensorfarm_pictures.so`) that is loaded with the first such picture.

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "world/bitmap.h"

namespace sf::world {

/// One row of a picture. Valid only during the call that receives it.
struct PixelRow {
  std::span<const std::uint8_t> rgba;  ///< 4 bytes per pixel; deeper samples are scaled down, alpha 255 is opaque
  bool has_alpha = false;              ///< the picture's format stores an alpha channel
};

/// Receives the rows of a picture.
class PictureSink {
 public:
  /// @param file name for errors; must outlive the sink  @param most_side [pixel]
  PictureSink(const std::string& file, std::uint32_t most_side) : file_(file), most_side_(most_side) {}
  virtual ~PictureSink() = default;

  const std::string& file() const { return file_; }
  std::uint32_t width() const { return width_; }    ///< [pixel] after `begin`
  std::uint32_t height() const { return height_; }  ///< [pixel] after `begin`
  /// Precedes the first row. @throws base::InputError if the size is out of bounds
  void begin(std::uint64_t width, std::uint64_t height);
  /// Adds the next row, from the top.
  virtual void add(const PixelRow& row) = 0;

 protected:
  /// Checks the size further.
  virtual void start() = 0;

 private:
  const std::string& file_;
  std::uint32_t most_side_;
  std::uint32_t width_ = 0, height_ = 0;
};

inline constexpr std::size_t kMostPictureBytes = 300u << 20;  ///< per file; the largest 8-bit PGM has 256 MiB

/// Decodes a picture. Checks sizes before allocating memory. @param bytes of the whole file
/// @throws base::InputError if the picture is broken, truncated, of another format or too large, or if the plug-in for
/// its format cannot be loaded
void decode_picture(const std::string& bytes, PictureSink& out);

/// Sets `solid` for each pixel of a row: 1 solid, 0 free. Called for all rows, from the top.
using SolidRule = std::function<void(const PixelRow& row, std::uint8_t* solid)>;

/// Returns the picture as a grid of the same size, 1 to 16384 pixels along each side. The top row of the picture is the
/// last row of the grid.
/// @throws base::InputError if the file is missing, and as decode_picture
Bitmap read_bitmap(const std::string& file, const SolidRule& rule);

/// Same, from memory. @param file name for errors
Bitmap decode_bitmap(const std::string& file, const std::string& bytes, const SolidRule& rule);

/// The interface of the plug-in.
struct PictureDecoder {
  /// Calls `row` for each row from the top. The picture's header has been checked.
  /// @param file read again for a GIF
  /// @param bytes its content
  /// @return empty, or the reason why the picture cannot be decoded
  std::string (*decode)(const std::string& file, const std::string& bytes, std::uint32_t width, std::uint32_t height,
                        const std::function<void(const PixelRow&)>& row);
};

/// Name of the plug-in's only symbol: `extern "C" const PictureDecoder sensorfarm_pictures`.
inline constexpr const char* kPicturesSymbol = "sensorfarm_pictures";

}  // namespace sf::world
