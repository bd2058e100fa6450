#include "viz/picture_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/png.h"
#include "viz/drawing_backend.h"
#include "viz/png.h"
#include "viz/svg.h"

namespace sf::viz {
namespace {

constexpr double kLargestPicture = 32768.0;  // [px] limit of Cairo

}  // namespace

std::optional<PictureFormat> format_of(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (suffix.empty() || suffix == ".png") return PictureFormat::png;
  if (suffix == ".svg") return PictureFormat::svg;
  if (suffix == ".pdf") return PictureFormat::pdf;
  return std::nullopt;
}

int page_pixels(const Page& page, double millimetres, int otherwise) {
  return static_cast<int>((millimetres > 0.0 ? millimetres * kPixelsPerMillimetre : otherwise) / page_scale(page));
}

double page_edge(const Page& page) {
  constexpr int kNarrow = 600;
  return page.width > 0.0 && page_pixels(page, page.width, 0) < kNarrow ? 12.0 : 26.0;
}

PixelImage paint_pixels(const Drawing& drawing, double scale) {
  PixelImage image{static_cast<int>(std::ceil(drawing.width * scale - 1e-6)),
                   static_cast<int>(std::ceil(drawing.height * scale - 1e-6)),
                   {}};
  if (!drawing_backend().pixels(drawing, scale, image.rgb))
    throw base::InputError(fmt::format(
        "cannot paint a picture of {} x {} pixels: not enough memory; use fewer dots per inch or a smaller size",
        image.width, image.height));
  return image;
}

std::string picture_bytes(const Drawing& drawing, const std::string& path, const Page& page) {
  const PictureFormat format = format_of(path).value_or(PictureFormat::png);
  if (format == PictureFormat::svg) return to_svg(drawing, page_scale(page));
  if (format == PictureFormat::pdf) {
    std::string bytes;
    SF_CHECK(drawing_backend().pdf(drawing, page_scale(page), bytes), "Cairo did not create a PDF");
    return bytes;
  }
  const double scale = page_scale(page) * page.dpi / kPixelsPerInch;
  if (scale * std::max(drawing.width, drawing.height) > kLargestPicture)
    throw base::InputError(path, 0,
                           fmt::format("the picture would be {:.0f} x {:.0f} pixels, more than {:g} along a side; use "
                                       "fewer dots per inch or a smaller size",
                                       drawing.width * scale, drawing.height * scale, kLargestPicture));
  const PixelImage image = paint_pixels(drawing, scale);
  return base::encode_png(image.rgb, image.width, image.height, base::PngContent::figure, page.dpi);
}

void save_picture(const Drawing& drawing, const std::string& path, const Page& page) {
  write_picture(path, picture_bytes(drawing, path, page));
}

}  // namespace sf::viz
