#pragma once
// The frame of a figure of a piece of the world, seen from above, north (+y) up: title, axes in metres, grid, legend,
// scale bar.
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
  world::Extent extent;                      ///< [m] smallest area to show; finite; a zero size is enlarged
  double margin = 0.03;                      ///< [-] free margin around `extent`, relative to its longer side
  std::uint32_t background = theme::kWhite;  ///< of the plot
  std::vector<LegendItem> legend;
  int long_side = 1600;  ///< [px] of the whole picture, in [600, 8000]; a page with a size of its own has priority
  Page page;
};

/// Positions of the parts of a figure. All [px] but `shown`.
struct FigureLayout {
  int width = 0;
  int height = 0;
  PixelBox plot;
  world::Extent shown;         ///< [m] area of the plot; contains the requested extent
  double scale = 1.0;          ///< [px/m] the same along x and y
  double tick_spacing = 90.0;  ///< at least; wide enough for the widest label along x
  Ticks x, y;                  ///< of equal spacing, but for a side with room for less than two
  std::vector<LegendPlace> legend;
  double legend_top = 0.0;
  Heading heading;
};
FigureLayout lay_out(const FigureOptions& options);

/// True where the box of `points` reaches into `shown` [m].
bool is_in_view(std::span<const glm::dvec2> points, const world::Extent& shown, double reach = 0.0);
/// The world with those of its objects that the figure shows, for its legend: all where the page has no extent.
world::World in_view(const world::World& world, const FigureOptions& options);

class Axes {
 public:
  /// Paints background and grid. Until `save`, drawing on the canvas is clipped to the plot.
  explicit Axes(FigureOptions options);
  /// A bare picture: the plot alone, white and without grid, which is not to be saved as a figure.
  explicit Axes(const FigureLayout& layout);

  Canvas& canvas() { return canvas_; }
  const FigureLayout& layout() const { return layout_; }
  /// [px] of a point of the world [m].
  glm::dvec2 pixel(glm::dvec2 p_W) const {
    return {layout_.plot.x_min + (p_W.x - layout_.shown.x_min) * layout_.scale,
            layout_.plot.y_max - (p_W.y - layout_.shown.y_min) * layout_.scale};
  }
  double scale() const { return layout_.scale; }

  /// Adds frame, ticks, texts and legend, and writes the picture in the format of its suffix.
  /// @throws base::InputError naming the path when it cannot be written.
  void save(const std::string& path);

 private:
  FigureOptions options_;
  FigureLayout layout_;
  Canvas canvas_;
};

}  // namespace sf::viz
