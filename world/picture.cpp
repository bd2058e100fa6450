#include "world/picture.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/files.h"
#include "base/plugin.h"
#include "world/picture_formats.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMaxPixels = 16384;    // per side
constexpr std::size_t kMaxBytes = 300u << 20;  // per file; the largest 8-bit PGM has 256 MiB

const PictureDecoder& plugin() {
  static const auto* const loaded = static_cast<const PictureDecoder*>(
      base::load_plugin(kPicturesSymbol, "only PNG and Netpbm pictures can be read; convert this one to PNG",
                        "OpenCV 4.6 (Debian: libopencv-imgcodecs406)"));
  return *loaded;
}

/// Decodes a picture with the plug-in. Returns false for another format.
bool decode_by_plugin(const std::string& bytes, GridBuilder& grid) {
  const auto size = size_in_header(grid.file(), bytes);
  if (!size) return false;
  grid.begin(size->width, size->height);
  grid.check_whole("a JPEG, BMP or GIF");
  const std::string problem = plugin().decode(grid.file(), bytes, grid.grid().width, grid.grid().height,
                                              [&](const PixelRow& row) { grid.add(row); });
  if (!problem.empty())
    throw base::InputError(grid.file(), 0, fmt::format("the picture cannot be decoded: {}; save it again", problem));
  return true;
}

}  // namespace

void GridBuilder::begin(std::uint64_t width, std::uint64_t height) {
  if (width < 1 || height < 1 || width > kMaxPixels || height > kMaxPixels)
    throw base::InputError(
        file_, 0,
        fmt::format("a picture of {} x {} pixels; expected 1 to {} along each side", width, height, kMaxPixels));
  grid_.width = static_cast<std::uint32_t>(width);
  grid_.height = static_cast<std::uint32_t>(height);
}

void GridBuilder::check_whole(const char* kind) const {
  if (std::size_t{grid_.width} * grid_.height <= kMaxWhole) return;
  throw base::InputError(file_, 0,
                         fmt::format("{} of {} x {} pixels; expected at most {} of them: save it as a PNG without "
                                     "interlacing",
                                     kind, grid_.width, grid_.height, kMaxWhole));
}

void GridBuilder::add(const PixelRow& row) {
  grid_.solid.resize(std::size_t{grid_.width} * grid_.height);
  rule_(row, grid_.solid.data() + std::size_t{grid_.height - ++rows_} * grid_.width);
}

Bitmap decode_bitmap(const std::string& file, const std::string& bytes, const SolidRule& rule) {
  GridBuilder grid(file, rule);
  if (bytes.starts_with("\x89PNG")) {
    decode_png(bytes, grid);
  } else if (bytes.size() > 1 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6') {
    decode_netpbm(bytes, grid);
  } else if (!decode_by_plugin(bytes, grid)) {
    throw base::InputError(file, 0, "is not a picture in PNG, Netpbm (P1 to P6), JPEG, BMP or GIF; convert it to PNG");
  }
  return std::move(grid.grid());
}

Bitmap read_bitmap(const std::string& file, const SolidRule& rule) {
  return decode_bitmap(file, base::read_bytes(file, kMaxBytes), rule);
}

}  // namespace sf::world
