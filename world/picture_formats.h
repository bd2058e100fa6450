#pragma once
// The decoders behind world/picture.h. All throw base::InputError for a broken picture.

#include <cstdint>
#include <optional>
#include <string>

#include "world/picture.h"

namespace sf::world {

/// Pixels of pictures that are decoded as a whole, in several times their size: interlaced PNG, JPEG, BMP, GIF.
inline constexpr std::size_t kMaxWhole = 1u << 26;

/// Turns rows into the cells of a grid.
class GridBuilder {
 public:
  GridBuilder(const std::string& file, const SolidRule& rule) : file_(file), rule_(rule) {}

  const std::string& file() const { return file_; }
  /// Allocates the grid. @throws base::InputError for a size out of bounds
  void begin(std::uint64_t width, std::uint64_t height);
  /// @throws base::InputError for more than kMaxWhole pixels, naming `kind` ("an interlaced picture")
  void check_whole(const char* kind) const;
  /// Adds the next row, from the top.
  void add(const PixelRow& row);
  Bitmap& grid() { return grid_; }

 private:
  const std::string& file_;
  const SolidRule& rule_;
  Bitmap grid_;
  std::uint32_t rows_ = 0;  ///< added
};

void decode_png(const std::string& bytes, GridBuilder& grid);
/// P1 to P6.
void decode_netpbm(const std::string& bytes, GridBuilder& grid);

struct PictureSize {
  std::uint64_t width = 0, height = 0;  ///< [pixel]
};

/// The size in the header of a JPEG, BMP or GIF; nullopt for other formats. Of a JPEG, the whole structure is checked,
/// since libjpeg fills what is missing with grey.
std::optional<PictureSize> size_in_header(const std::string& file, const std::string& bytes);

}  // namespace sf::world
