#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "viz/axes.h"
#include "viz/ticks.h"

namespace sf::viz {
namespace {

constexpr double kEdge = 26.0;        // around the whole figure
constexpr double kTicksBelow = 68.0;  // tick labels and the axis' name
constexpr double kAxisName = 34.0;    // left of the tick labels
constexpr double kSmallestWide = 620.0;
constexpr double kSmallestHigh = 260.0;

struct Size {
  double x = 0.0, y = 0.0;
};

/// The extent with its margin, never empty.
world::Extent padded(const FigureOptions& options) {
  world::Extent e = options.page.extent.value_or(options.extent);
  SF_CHECK(std::isfinite(e.x_min + e.x_max + e.y_min + e.y_max) && e.x_min <= e.x_max && e.y_min <= e.y_max,
           "the extent of a figure must be finite and in order");
  double pad = options.page.extent ? 0.0 : options.margin * std::max(e.x_max - e.x_min, e.y_max - e.y_min);
  if (e.x_min == e.x_max && e.y_min == e.y_max) pad = 1.0;
  e.x_min -= pad, e.y_min -= pad, e.x_max += pad, e.y_max += pad;
  return e;
}

/// [px] of the labels of one axis.
double widest_label(double from, double to, double smallest_step) {
  const Ticks ticks = make_ticks(from, to, smallest_step);
  double widest = 0.0;
  for (const double value : ticks.at)
    widest = std::max(widest, text_size(tick_text(value, ticks.decimals), small_text()).x);
  return widest;
}

/// Grows one side of `shown` about its middle so that it fills `plot` at `scale`.
void fill_plot(world::Extent& shown, Size plot, double scale) {
  const double more_x = std::max(0.0, plot.x / scale - (shown.x_max - shown.x_min)) / 2.0;
  const double more_y = std::max(0.0, plot.y / scale - (shown.y_max - shown.y_min)) / 2.0;
  shown.x_min -= more_x, shown.x_max += more_x, shown.y_min -= more_y, shown.y_max += more_y;
}

}  // namespace

FigureLayout lay_out(const FigureOptions& options) {
  SF_CHECK(options.long_side >= 600 && options.long_side <= 8000,
           "long side " + std::to_string(options.long_side) + " px");
  const world::Extent wanted = padded(options);
  const Size extent{std::max(wanted.x_max - wanted.x_min, 1e-9), std::max(wanted.y_max - wanted.y_min, 1e-9)};
  const double width = page_pixels(options.page.width, options.long_side);
  // A column is narrow beside its texts: a figure of a given width alone may be higher than wide.
  const double height =
      page_pixels(options.page.height, static_cast<int>(options.page.width > 0.0 ? 1.6 * width : width));

  // Labels, legend and scale depend on each other; two iterations suffice.
  FigureLayout layout;
  double left = kEdge + kAxisName + 40.0;
  double footer = kTicksBelow + kLegendRow + kEdge;
  double heading_width = width - left - kEdge;
  for (int round = 0; round < 3; ++round) {
    layout.heading = make_heading(options.title, options.subtitle, heading_width, options.page);
    const double header = layout.heading.height;
    const Size room{width - left - kEdge, std::max(height - header - footer, 1.0)};
    layout.scale = std::min(room.x / extent.x, room.y / extent.y);
    const Size plot{std::clamp(std::round(extent.x * layout.scale), std::min(kSmallestWide, room.x), room.x),
                    std::clamp(std::round(extent.y * layout.scale), std::min(kSmallestHigh, room.y), room.y)};
    layout.shown = wanted;
    fill_plot(layout.shown, plot, layout.scale);
    layout.plot = {static_cast<int>(std::ceil(left)), static_cast<int>(std::ceil(header)), 0, 0};
    layout.plot.x_max = layout.plot.x_min + static_cast<int>(plot.x);
    layout.plot.y_max = layout.plot.y_min + static_cast<int>(plot.y);

    // The scale bar is in the row of the axis' name, so the legend has the whole width.
    layout.legend = place_legend(options.legend, plot.x);
    const int rows = layout.legend.empty() ? 0 : layout.legend.back().row + 1;
    const double x_label = widest_label(layout.shown.x_min, layout.shown.x_max, layout.tick_spacing / layout.scale);
    layout.tick_spacing = std::max(layout.tick_spacing, x_label + 20.0);
    left = kEdge + kAxisName +
           widest_label(layout.shown.y_min, layout.shown.y_max, layout.tick_spacing / layout.scale) + 14.0;
    footer = kTicksBelow + rows * kLegendRow + kEdge;
    heading_width = layout.plot.x_max + kEdge - left - kEdge;
  }
  layout.legend_top = layout.plot.y_max + kTicksBelow + 8.0;
  layout.width = static_cast<int>(std::ceil(layout.plot.x_max + kEdge));
  layout.height = static_cast<int>(std::ceil(layout.plot.y_max + footer));
  return layout;
}

}  // namespace sf::viz
