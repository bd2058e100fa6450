#pragma once
// The decoders behind world/picture.h. All throw base::InputError for a broken picture.

#include <cstdint>
#include <optional>
#include <string>

#include "world/picture.h"

namespace sf::world {

/// Largest number of pixels of pictures that are decoded as a whole, which takes several times their size: interlaced
/// PNG, JPEG, BMP, GIF.
inline constexpr std::size_t kMaxWhole = 1u << 26;

/// Converts rows to the cells of a grid.
class GridBuilder {
 public:
  GridBuilder(const std::string& file, const SolidRule& rule) : file_(file), rule_(rule) {}

  const std::string& file() const { return file_; }
  /// Allocates the grid. @throws base::InputError if the size is out of bounds
  void begin(std::uint64_t width, std::uint64_t height);
  /// @throws base::InputError for more than kMaxWhole pixels, with `kind` ("an interlaced picture") in the message
  void check_whole(const char* kind) const;
  /// Adds the next row, from the top.
  void add(const PixelRow& row);
  Bitmap& grid() { return grid_; }

 private:
  const std::string& file_;
  const SolidRule& rule_;
  Bitmap grid_;
  std::uint32_t rows_ = 0;  ///< number of rows added
};

void decode_png(const std::string& bytes, GridBuilder& grid);
/// Decodes P1 to P6.
void decode_netpbm(const std::string& bytes, GridBuilder& grid);

struct PictureSize {
  std::uint64_t width = 0, height = 0;  ///< [pixel]
};

/// Returns the size in the header of a JPEG, BMP or GIF; nullopt for other formats. Checks the whole structure of a
/// JPEG, since libjpeg fills missing parts with grey.
std::optional<PictureSize> size_in_header(const std::string& file, const std::string& bytes);

}  // namespace sf::world
