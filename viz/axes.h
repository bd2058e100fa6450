#pragma once
// The frame of a figure of a part of the world, seen from above with north (+y) up: title, axes in metres, grid,
// legend, scale bar.
//
//   Axes axes({.title = "cave", .extent = world.extent, .legend = {...}});
//   axes.canvas().line(axes.pixel(a), axes.pixel(b), 1.5, 0xFF000000);   // clipped to the plot
//   axes.save("cave.png");

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/heading.h"
#include "viz/legend.h"
#include "viz/theme.h"
#include "viz/ticks.h"
#include "world/world.h"

namespace sf::viz {

struct FigureOptions {
  std::string title;
  std::string subtitle;
  world::Extent extent;                      ///< [m] smallest area to show; finite; an empty one is enlarged
  double margin = 0.03;                      ///< [-] free margin around `extent`, relative to its longer side
  std::uint32_t background = theme::kWhite;  ///< of the plot
  std::vector<LegendItem> legend;
  int long_side = 1600;  ///< [px] of the whole picture, in [600, 8000]; ignored if the page has a size
  Page page;
};

/// Positions of the parts of a figure. All [px] except `shown`.
struct FigureLayout {
  int width = 0;
  int height = 0;
  PixelBox plot;
  world::Extent shown;         ///< [m] area of the plot; contains the requested extent
  double scale = 1.0;          ///< [px/m] the same along x and y
  double tick_spacing = 90.0;  ///< minimum; wide enough for the widest label along x
  Ticks x, y;                  ///< equally spaced, unless a side has room for fewer than two
  std::vector<LegendPlace> legend;
  double legend_top = 0.0;
  Heading heading;
};
FigureLayout lay_out(const FigureOptions& options);

/// True if the bounding box of `points` is within `reach` [m] of `shown`.
bool is_in_view(std::span<const glm::dvec2> points, const world::Extent& shown, double reach = 0.0);
/// Returns the world with only the objects that the figure shows, for its legend; all objects if the page has no
/// extent.
world::World in_view(const world::World& world, const FigureOptions& options);

class Axes {
 public:
  /// Paints background and grid. Drawing on the canvas is clipped to the plot until `save`.
  explicit Axes(FigureOptions options);
  /// Creates a bare plot, white and without a grid. It cannot be saved as a figure.
  explicit Axes(const FigureLayout& layout);

  Canvas& canvas() { return canvas_; }
  const FigureLayout& layout() const { return layout_; }
  /// Returns the pixel of a point in the world [m].
  glm::dvec2 pixel(glm::dvec2 p_W) const {
    return {layout_.plot.x_min + (p_W.x - layout_.shown.x_min) * layout_.scale,
            layout_.plot.y_max - (p_W.y - layout_.shown.y_min) * layout_.scale};
  }
  double scale() const { return layout_.scale; }

  /// Adds frame, ticks, texts and legend, and writes the picture in the format given by its suffix.
  /// @throws base::InputError naming the path if it cannot be written.
  void save(const std::string& path);

 private:
  FigureOptions options_;
  FigureLayout layout_;
  Canvas canvas_;
};

}  // namespace sf::viz
