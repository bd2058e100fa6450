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

/// Colours of occupancy maps: the greys of ROS' map_server, or those of the thesis with blue obstacles.
enum class MapColors : std::uint8_t { ros, thesis };

inline constexpr double kUsualFontSize = 7.2;    ///< [pt] 18 layout pixels
inline constexpr double kWidthPerPoint = 6.0;    ///< [mm/pt] smallest width of a page per size of its font
inline constexpr double kLargestColumn = 240.0;  ///< [mm] height that figures without a stated one keep to

/// How a figure is laid out and written. Lengths on paper are in millimetres.
/// Rule: width >= kWidthPerPoint * font_size, unless it is 0.
struct Page {
  double width = 0.0;                   ///< [mm] in [50, 1000]; 0: the figure's own, about 226
  double height = 0.0;                  ///< [mm] at most, in [30, 1000]; 0: the figure's own
  double dpi = 180.0;                   ///< [1/inch] of PNG files, in [50, 1200]
  bool title = true;                    ///< with title and subtitle
  std::optional<world::Extent> extent;  ///< [m] area that figures of a world show; nullopt: all
  double font_size = kUsualFontSize;    ///< [pt] of axes and legends, in [5, 24]; lines and marks grow with it
  bool line_styles = true;              ///< curves differ in their dashes, too, for print without colours
  MapColors map_colors = MapColors::ros;
};

/// [-] of a page's layout on paper: 1 where 18 layout pixels are letters of 7.2 points.
inline double page_scale(const Page& page) { return page.font_size / kUsualFontSize; }

/// [px] of the layout: a length of a page, or `otherwise` [px of 1/180 inch on paper] where the page leaves it open.
int page_pixels(const Page& page, double millimetres, int otherwise);

/// [px] free border of a figure; smaller where the page is narrow.
double page_edge(const Page& page);

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
