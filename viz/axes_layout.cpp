#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "viz/axes.h"
#include "viz/scales.h"

namespace sf::viz {
namespace {

constexpr double kTicksBelow = 68.0;  // tick labels and the name of the axis
constexpr double kAxisName = 34.0;    // left of the tick labels
constexpr double kLowestMap = 60.0;   // smallest height of the map on a page with a height
constexpr double kLowestPart = 0.4;   // otherwise the smallest height relative to the width
constexpr double kSmallestWide = 620.0;
constexpr double kSmallestHigh = 260.0;

struct Size {
  double x = 0.0, y = 0.0;
};

/// Returns the extent with its margin; never empty.
world::Extent padded(const FigureOptions& options) {
  world::Extent e = options.page.extent.value_or(options.extent);
  SF_CHECK(std::isfinite(e.x_min + e.x_max + e.y_min + e.y_max) && e.x_min <= e.x_max && e.y_min <= e.y_max,
           "the extent of a figure must be finite and in order");
  double pad = options.page.extent ? 0.0 : options.margin * std::max(e.x_max - e.x_min, e.y_max - e.y_min);
  if (e.x_min == e.x_max && e.y_min == e.y_max) pad = 1.0;
  e.x_min -= pad, e.y_min -= pad, e.x_max += pad, e.y_max += pad;
  return e;
}

/// Ticks with the layout's spacing, or closer ones.
Ticks ticks_x(const FigureLayout& at) {
  const Ticks ticks = make_ticks(at.shown.x_min, at.shown.x_max, at.tick_spacing / at.scale);
  return ticks.at.size() > 1 ? ticks : ticks_across(at.shown.x_min, at.shown.x_max, at.plot.x_max - at.plot.x_min);
}
Ticks ticks_y(const FigureLayout& at) {
  const Ticks ticks = make_ticks(at.shown.y_min, at.shown.y_max, at.tick_spacing / at.scale);
  return ticks.at.size() > 1 ? ticks : ticks_up(at.shown.y_min, at.shown.y_max, at.plot.y_max - at.plot.y_min);
}

/// Extends one side of `shown` symmetrically so that it fills `plot` at `scale`.
void fill_plot(world::Extent& shown, Size plot, double scale) {
  const double more_x = std::max(0.0, plot.x / scale - (shown.x_max - shown.x_min)) / 2.0;
  const double more_y = std::max(0.0, plot.y / scale - (shown.y_max - shown.y_min)) / 2.0;
  shown.x_min -= more_x, shown.x_max += more_x, shown.y_min -= more_y, shown.y_max += more_y;
}

}  // namespace

bool is_in_view(std::span<const glm::dvec2> points, const world::Extent& shown, double reach) {
  glm::dvec2 low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
  for (const glm::dvec2& p : points) low = glm::min(low, p), high = glm::max(high, p);
  return high.x + reach >= shown.x_min && low.x - reach <= shown.x_max && high.y + reach >= shown.y_min &&
         low.y - reach <= shown.y_max;
}

world::World in_view(const world::World& world, const FigureOptions& options) {
  world::World seen = world;
  if (!options.page.extent) return seen;
  const world::Extent shown = lay_out(options).shown;
  const auto hidden = [&](glm::dvec2 p, double reach) { return !is_in_view({&p, 1}, shown, reach); };
  std::erase_if(seen.walls, [&](const world::Segment& s) {
    const glm::dvec2 ends[] = {s.a, s.b};
    return !is_in_view(ends, shown);
  });
  std::erase_if(seen.lane_markings, [&](const auto& m) { return !is_in_view(m.line, shown, 0.5 * m.width); });
  std::erase_if(seen.floor_holes, [&](const auto& hole) { return !is_in_view(hole.outline, shown); });
  std::erase_if(seen.magnets, [&](const auto& m) { return hidden(m.p, m.radius); });
  std::erase_if(seen.movers, [&](const auto& m) { return hidden({m.X_WM.x, m.X_WM.y}, m.radius); });
  std::erase_if(seen.lights, [&](const auto& l) { return hidden({l.X_WL.x, l.X_WL.y}, 0.0); });
  std::erase_if(seen.emitters, [&](const auto& e) { return hidden({e.X_WE.x, e.X_WE.y}, std::max(e.range, e.halo)); });
  std::erase_if(seen.lamps, [&](const auto& l) { return hidden({l.X_WL.x, l.X_WL.y}, 0.0); });
  return seen;
}

FigureLayout lay_out(const FigureOptions& options) {
  SF_CHECK(options.long_side >= 600 && options.long_side <= 8000,
           "long side " + std::to_string(options.long_side) + " px");
  const world::Extent wanted = padded(options);
  const Size extent{std::max(wanted.x_max - wanted.x_min, 1e-9), std::max(wanted.y_max - wanted.y_min, 1e-9)};
  const Page& page = options.page;
  const double width = page_pixels(page, page.width, options.long_side);
  // A column is narrow compared with its texts: a figure with only a width may be taller than wide, up to the height of
  // a column.
  const double height = page.height > 0.0  ? page_pixels(page, page.height, 0)
                        : page.width > 0.0 ? std::min(1.6 * width, page_pixels(page, kLargestColumn, 0) + 0.0)
                                           : width;
  const double edge = page_edge(page);

  // Labels, legend and scale depend on each other; two iterations are enough.
  FigureLayout layout;
  double left = edge + kAxisName + 40.0;
  double footer = kTicksBelow + kLegendRow + edge;
  double heading_width = width - left - edge;
  for (int round = 0; round < 3; ++round) {
    layout.heading = make_heading(options.title, options.subtitle, heading_width, page);
    const double header = layout.heading.height;
    const double lowest = page.height > 0.0 ? kLowestMap : kLowestPart * (width - left - edge);
    const Size room{width - left - edge, std::max(height - header - footer, lowest)};
    layout.scale = std::min(room.x / extent.x, room.y / extent.y);
    if (round == 0) layout.tick_spacing = std::min(layout.tick_spacing, room.x / 4.0);
    const Size plot{std::clamp(std::round(extent.x * layout.scale), std::min(kSmallestWide, room.x), room.x),
                    std::clamp(std::round(extent.y * layout.scale), std::min(kSmallestHigh, room.y), room.y)};
    layout.shown = wanted;
    fill_plot(layout.shown, plot, layout.scale);
    layout.plot = {static_cast<int>(std::ceil(left)), static_cast<int>(std::ceil(header)), 0, 0};
    layout.plot.x_max = layout.plot.x_min + static_cast<int>(plot.x);
    layout.plot.y_max = layout.plot.y_min + static_cast<int>(plot.y);

    // The scale bar is in the row of the axis name, so the legend can use the full width.
    layout.legend = place_legend(options.legend, layout.plot.x_max - legend_left(page, layout.plot.x_min));
    const int rows = layout.legend.empty() ? 0 : layout.legend.back().row + 1;
    layout.tick_spacing = std::max(layout.tick_spacing, widest_label(ticks_x(layout)) + 20.0);
    left = edge + kAxisName + widest_label(ticks_y(layout)) + 14.0;
    footer = kTicksBelow + rows * kLegendRow + edge;
    heading_width = layout.plot.x_max + edge - left - edge;
  }
  // At least two labels along x, if there is room.
  const auto equal = [&] {
    return make_ticks(layout.shown.x_min, layout.shown.x_max, layout.tick_spacing / layout.scale);
  };
  const double least = widest_label(equal()) + 14.0;
  while (equal().at.size() < 2 && 0.8 * layout.tick_spacing > least) layout.tick_spacing *= 0.8;
  layout.x = ticks_x(layout);
  layout.y = ticks_y(layout);
  layout.legend_top = layout.plot.y_max + kTicksBelow + 8.0;
  layout.width = static_cast<int>(std::ceil(layout.plot.x_max + edge));
  layout.height = static_cast<int>(std::ceil(layout.plot.y_max + footer));
  return layout;
}

}  // namespace sf::viz
