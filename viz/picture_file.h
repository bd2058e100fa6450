#pragma once
// Writes drawings as PNG, SVG or PDF by the file's suffix, with the page settings of the user.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "viz/drawing.h"
#include "world/world.h"

namespace sf::viz {

enum class PictureFormat { png, svg, pdf };

/// Returns the format for the suffix in any case; PNG without a suffix; nullopt for other suffixes.
std::optional<PictureFormat> format_of(const std::string& path);

/// Colours of occupancy maps: the greys of ROS' map_server, or those of the thesis with blue obstacles.
enum class MapColors : std::uint8_t { ros, thesis };

inline constexpr double kUsualFontSize = 7.2;    ///< [pt] 18 layout pixels
inline constexpr double kWidthPerPoint = 6.0;    ///< [mm/pt] smallest page width per font size
inline constexpr double kLargestColumn = 240.0;  ///< [mm] largest height of figures without a specified one

/// Layout and output settings of a figure. Lengths are in millimetres on paper. Rule: width >= kWidthPerPoint *
/// font_size, unless it is 0.
struct Page {
  double width = 0.0;                   ///< [mm] in [50, 1000]; 0: the figure's own width, about 226
  double height = 0.0;                  ///< [mm] maximum height, in [30, 1000]; 0: the figure's own
  double dpi = 180.0;                   ///< [1/inch] of PNG files, in [50, 1200]
  bool title = true;                    ///< draw title and subtitle
  std::optional<world::Extent> extent;  ///< [m] area shown by figures of a world; nullopt: all
  double font_size = kUsualFontSize;    ///< [pt] of axes and legends, in [5, 24]; lines and marks scale with it
  bool line_styles = true;              ///< curves also differ in their dashes, for print without colours
  MapColors map_colors = MapColors::ros;
};

/// [-] Scale of a page's layout on paper: 1 if 18 layout pixels are 7.2 points.
inline double page_scale(const Page& page) { return page.font_size / kUsualFontSize; }

/// Converts a length on the page to layout pixels. Returns `otherwise` [px of 1/180 inch on paper] if it is 0.
int page_pixels(const Page& page, double millimetres, int otherwise);

/// [px] Returns the margin of a figure; smaller on a narrow page.
double page_edge(const Page& page);

/// The pixels of a drawing.
struct PixelImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< row by row, the top row first
};
PixelImage paint_pixels(const Drawing& drawing, double scale = 1.0);

/// Returns the bytes of a picture file. @param path its suffix is the format; named in errors
/// @throws base::InputError if the picture would have more than 32768 pixels along a side
std::string picture_bytes(const Drawing& drawing, const std::string& path, const Page& page = {});

/// @throws base::InputError naming the path if it cannot be written, and as picture_bytes
void save_picture(const Drawing& drawing, const std::string& path, const Page& page = {});

}  // namespace sf::viz
