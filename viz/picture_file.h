#pragma once
// Drawings as files: PNG, SVG or PDF by the file's suffix. And the choices of a user about them.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "viz/drawing.h"
#include "world/world.h"

namespace sf::viz {

enum class PictureFormat { png, svg, pdf };

/// By the suffix in any case; PNG without one. nullopt: another suffix.
std::optional<PictureFormat> format_of(const std::string& path);

/// How a figure is laid out and written. Lengths on paper are in millimetres.
struct Page {
  double width = 0.0;                   ///< [mm] in [85, 1000]; 0: the figure's own, about 226
  double height = 0.0;                  ///< [mm] at most, in [60, 1000]; 0: the figure's own
  double dpi = 180.0;                   ///< [1/inch] of PNG files, in [50, 1200]
  bool title = true;                    ///< with title and subtitle
  std::optional<world::Extent> extent;  ///< [m] area that figures of a world show; nullopt: all
};

/// [px] a length of a page, or `otherwise` where the page leaves it open.
int page_pixels(double millimetres, int otherwise);

/// The pixels of a drawing.
struct PixelImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< row by row, the top row first
};
PixelImage paint_pixels(const Drawing& drawing, double scale = 1.0);

/// @throws base::InputError naming the path when it cannot be written, or when the picture would have more than 32768
/// pixels along a side.
void save_picture(const Drawing& drawing, const std::string& path, const Page& page = {});

}  // namespace sf::viz
