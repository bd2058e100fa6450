#include "world/picture.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/files.h"
#include "base/plugin.h"
#include "world/picture_formats.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMaxPixels = 16384;  // per side of a grid

const PictureDecoder& plugin() {
  static const auto* const loaded = static_cast<const PictureDecoder*>(
      base::load_plugin(kPicturesSymbol, "only PNG and Netpbm pictures can be read; convert this one to PNG",
                        "OpenCV 4.6 (Debian: libopencv-imgcodecs406)"));
  return *loaded;
}

/// Decodes a picture with the plug-in. Returns false for another format.
bool decode_by_plugin(const std::string& bytes, PictureSink& out) {
  const auto size = size_in_header(out.file(), bytes);
  if (!size) return false;
  out.begin(size->width, size->height);
  check_whole(out, "a JPEG, BMP or GIF");
  const std::string problem =
      plugin().decode(out.file(), bytes, out.width(), out.height(), [&](const PixelRow& row) { out.add(row); });
  if (!problem.empty())
    throw base::InputError(out.file(), 0, fmt::format("the picture cannot be decoded: {}; save it again", problem));
  return true;
}

/// Converts rows to the cells of a grid.
class GridBuilder final : public PictureSink {
 public:
  GridBuilder(const std::string& file, const SolidRule& rule) : PictureSink(file, kMaxPixels), rule_(rule) {}
  void add(const PixelRow& row) override {
    grid_.solid.resize(std::size_t{grid_.width} * grid_.height);  // a header alone takes no memory
    rule_(row, grid_.solid.data() + std::size_t{grid_.height - ++rows_} * grid_.width);
  }
  Bitmap& grid() { return grid_; }

 private:
  void start() override { grid_.width = width(), grid_.height = height(); }
  const SolidRule& rule_;
  Bitmap grid_;
  std::uint32_t rows_ = 0;  ///< number of rows added
};

}  // namespace

void PictureSink::begin(std::uint64_t width, std::uint64_t height) {
  if (width < 1 || height < 1 || width > most_side_ || height > most_side_)
    throw base::InputError(
        file_, 0,
        fmt::format("a picture of {} x {} pixels; expected 1 to {} along each side", width, height, most_side_));
  width_ = static_cast<std::uint32_t>(width), height_ = static_cast<std::uint32_t>(height);
  start();
}

void check_whole(const PictureSink& picture, const char* kind) {
  if (std::size_t{picture.width()} * picture.height() <= kMaxWhole) return;
  throw base::InputError(picture.file(), 0,
                         fmt::format("{} of {} x {} pixels; expected at most {} of them: save it as a PNG without "
                                     "interlacing",
                                     kind, picture.width(), picture.height(), kMaxWhole));
}

void decode_picture(const std::string& bytes, PictureSink& out) {
  if (bytes.starts_with("\x89PNG"))
    decode_png(bytes, out);
  else if (bytes.size() > 1 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6')
    decode_netpbm(bytes, out);
  else if (!decode_by_plugin(bytes, out))
    throw base::InputError(out.file(), 0,
                           "is not a picture in PNG, Netpbm (P1 to P6), JPEG, BMP or GIF; convert it to PNG");
}

Bitmap decode_bitmap(const std::string& file, const std::string& bytes, const SolidRule& rule) {
  GridBuilder grid(file, rule);
  decode_picture(bytes, grid);
  return std::move(grid.grid());
}

Bitmap read_bitmap(const std::string& file, const SolidRule& rule) {
  return decode_bitmap(file, base::read_bytes(file, kMostPictureBytes), rule);
}

}  // namespace sf::world
