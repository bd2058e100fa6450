#include "viz/map_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "maps/map_text.h"
#include "viz/canvas.h"
#include "viz/color.h"
#include "viz/heading.h"
#include "viz/legend.h"
#include "viz/map_cells.h"
#include "viz/scales.h"
#include "viz/theme.h"

namespace sf::viz {

namespace {

constexpr std::size_t kNamedPlaces = 7;

// [px]
constexpr int kPitch = 5;  // a cell of 4 and a line of 1
constexpr std::int64_t kMaxWithGrid = 1600;
constexpr double kLongestMap = 8000.0;
constexpr double kMapLeft = 60.0;    // plus the page's edge: labels and name of the axis
constexpr double kMapRight = 14.0;   // plus the page's edge
constexpr double kMapLabels = 70.0;  // below the map
constexpr double kNarrowestMap = 640.0;
constexpr glm::dvec2 kShortestAxes{60.0, 40.0};

/// Position of the map in the picture.
struct Layout {
  double scale = kPitch;  ///< [px/cell]
  bool grid = true;
  glm::dvec2 low, high;            ///< [px] upper left and lower right corner of the map
  glm::dvec2 axes_low, axes_high;  ///< [px] the same for the axes, which are longer than a narrow map
  double width = 0.0;              ///< [px] of the picture
  double height = 0.0;
  std::vector<LegendPlace> legend;
  Heading heading;
  double left = 0.0, right = 0.0;  ///< [px] left and right of the map
};

Layout lay_out(const maps::GridGeometry& geometry, std::span<const LegendItem> legend, const MapFigure& figure,
               const std::string& subtitle, const Page& page) {
  Layout l;
  l.left = kMapLeft + page_edge(page);
  l.right = kMapRight + page_edge(page);
  const std::int64_t longest = std::max(maps::columns(geometry), maps::rows(geometry));
  l.grid = longest <= kMaxWithGrid && page.map_colors == MapColors::thesis;
  if (longest > kMaxWithGrid)
    l.scale = std::min(static_cast<double>(kPitch), kLongestMap / static_cast<double>(longest));
  const double narrowest = page_pixels(page, page.width, static_cast<int>(kNarrowestMap));
  if (page.width > 0.0) {
    const double room =
        page.height > 0.0 ? page_pixels(page, page.height, 0) - kMapLabels - 3.0 * kLegendRow : HUGE_VAL;
    l.scale = std::min((narrowest - l.left - l.right - 1.0) / static_cast<double>(maps::columns(geometry)),
                       std::max(room, 100.0) / static_cast<double>(maps::rows(geometry)));
    l.grid = false;
  }
  const double line = l.grid ? 1.0 : 0.0;
  const double wide = std::ceil(l.scale * static_cast<double>(maps::columns(geometry))) + line;
  const double high = std::ceil(l.scale * static_cast<double>(maps::rows(geometry))) + line;
  l.width = std::max(narrowest, l.left + wide + l.right);
  l.heading = make_heading(figure.title, subtitle, l.width - 2.0 * l.right, page);
  const glm::dvec2 size{wide, high}, axes = glm::max(size, kShortestAxes);
  l.axes_low = {std::floor(l.left + 0.5 * (l.width - l.left - l.right - axes.x)), std::ceil(l.heading.height)};
  l.axes_high = l.axes_low + axes;
  l.low = l.axes_low + glm::floor(0.5 * (axes - size));
  l.high = l.low + size;
  l.legend = place_legend(legend, l.width - 2.0 * l.right);
  l.height = l.axes_high.y + kMapLabels + kLegendRow * (l.legend.back().row + 1) + 12.0;
  return l;
}

std::vector<LegendItem> legend_of(const maps::CellCounts& census, const MapFigure& figure, MapColors colors) {
  std::vector<LegendItem> items = state_legend(census, colors);
  const std::size_t named = std::min(figure.places.size(), kNamedPlaces);
  for (std::size_t i = 0; i < named; ++i)
    items.push_back({LegendMark::robot, row_color(i + 1, named + 1), figure.places[i].name});
  if (named < figure.places.size()) items.push_back(more_item(figure.places.size() - named));
  return items;
}

void draw_cells(Canvas& canvas, const maps::OccupancyGrid& grid, const Layout& l, MapColors colors) {
  const std::vector<std::uint32_t> pixels = pixels_of(grid, colors);
  const glm::dvec2 line = l.grid ? glm::dvec2{1.0, 1.0} : glm::dvec2{};
  canvas.image(l.low + line, l.high,
               {static_cast<int>(maps::columns(grid.geometry)), static_cast<int>(maps::rows(grid.geometry)), pixels});
  if (!l.grid) return;
  // Drawn as single pixels, since lines would be anti-aliased.
  const std::vector<std::uint32_t> line_color{theme::kMapGrid};
  for (std::int64_t i = 0; i <= maps::columns(grid.geometry); ++i) {
    const double x = l.low.x + kPitch * static_cast<double>(i);
    canvas.image({x, l.low.y}, {x + 1.0, l.high.y}, {1, 1, line_color});
  }
  for (std::int64_t i = 0; i <= maps::rows(grid.geometry); ++i) {
    const double y = l.low.y + kPitch * static_cast<double>(i);
    canvas.image({l.low.x, y}, {l.high.x, y + 1.0}, {1, 1, line_color});
  }
}

/// [px] Returns the position of a point in the world.
glm::dvec2 pixel(const maps::GridGeometry& geometry, const Layout& l, glm::dvec2 p_W) {
  const double scale = l.scale / geometry.cell;
  return l.low + glm::dvec2{(p_W.x - geometry.left) * scale, (geometry.top - p_W.y) * scale};
}

void draw_axes(Canvas& canvas, const maps::GridGeometry& geometry, const Layout& l) {
  TextStyle style = small_text();
  style.across = Anchor::middle;
  style.down = Anchor::start;
  const double metre = l.scale / geometry.cell;  // [px]
  const double left = geometry.left - (l.low.x - l.axes_low.x) / metre,
               top = geometry.top + (l.low.y - l.axes_low.y) / metre;
  const double wide = l.axes_high.x - l.axes_low.x, high = l.axes_high.y - l.axes_low.y;
  const Ticks xs = ticks_across(left, left + wide / metre, wide);
  for (const double x : xs.at) {
    const double px = std::floor(pixel(geometry, l, {x, 0.0}).x) + 0.5;
    canvas.line({px, l.axes_high.y + 1.0}, {px, l.axes_high.y + 6.0}, theme::kHairline, theme::kFrame);
    draw_label_across(canvas, {px, l.axes_high.y + 10.0}, tick_text(x, xs));
  }
  canvas.text({0.5 * (l.axes_low.x + l.axes_high.x), l.axes_high.y + 36.0}, axis_name("x [m]", xs), style);
  style.across = Anchor::end;
  style.down = Anchor::middle;
  const Ticks ys = ticks_up(top - high / metre, top, high);
  for (const double y : ys.at) {
    const double py = std::floor(pixel(geometry, l, {0.0, y}).y) + 0.5;
    canvas.line({l.axes_low.x - 6.0, py}, {l.axes_low.x - 1.0, py}, theme::kHairline, theme::kFrame);
    canvas.text({l.axes_low.x - 10.0, py}, tick_text(y, ys), style);
  }
  style.across = Anchor::middle;
  style.upwards = true;
  canvas.text({std::max(l.axes_low.x - 66.0, 12.0), 0.5 * (l.axes_low.y + l.axes_high.y)}, axis_name("y [m]", ys),
              style);
}

void draw_places(Canvas& canvas, const maps::GridGeometry& geometry, const Layout& l, const MapFigure& figure) {
  canvas.clip(
      {static_cast<int>(l.low.x), static_cast<int>(l.low.y), static_cast<int>(l.high.x), static_cast<int>(l.high.y)});
  const std::size_t named = std::min(figure.places.size(), kNamedPlaces);
  for (std::size_t i = 0; i < figure.places.size(); ++i) {
    const base::Pose& X = figure.places[i].X_WR;
    const std::uint32_t color = row_color(1 + std::min(i, named - 1), named + 1);
    const glm::dvec2 p = pixel(geometry, l, {X.x, X.y});
    const glm::dvec2 ahead{std::cos(X.yaw), -std::sin(X.yaw)};
    canvas.disc(p, 9.0, with_opacity(color, 0.55));
    canvas.ring(p, 9.0, theme::kCurve, color);
    canvas.line(p, p + 14.0 * ahead, theme::kBold, color);
  }
  canvas.unclip();
}

}  // namespace

Drawing map_drawing(const maps::OccupancyGrid& grid, const MapFigure& figure, const Page& page) {
  const maps::CellCounts census = maps::count(grid);
  const std::vector<LegendItem> legend = legend_of(census, figure, page.map_colors);
  const double all = static_cast<double>(census.all());
  const double known = 100.0 * static_cast<double>(census.occupied + census.free) / all;
  const std::string subtitle = fmt::format("{}{}{} x {} cells of {:g} m, {:.1f} % explored", figure.subtitle,
                                           figure.subtitle.empty() ? "" : ": ", maps::columns(grid.geometry),
                                           maps::rows(grid.geometry), grid.geometry.cell, known);
  const Layout l = lay_out(grid.geometry, legend, figure, subtitle, page);
  Canvas canvas(static_cast<int>(std::ceil(l.width)), static_cast<int>(std::ceil(l.height)), theme::kWhite);
  draw_heading(canvas, l.right, l.heading);
  draw_cells(canvas, grid, l, page.map_colors);
  draw_places(canvas, grid.geometry, l, figure);
  draw_axes(canvas, grid.geometry, l);
  draw_legend(canvas, {l.right, l.axes_high.y + kMapLabels}, legend, l.legend);
  return canvas.drawing();
}

void draw_map(const maps::OccupancyGrid& grid, const MapFigure& figure, const std::string& path, const Page& page) {
  save_picture(map_drawing(grid, figure, page), path, page);
}

}  // namespace sf::viz
