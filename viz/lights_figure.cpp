#include "viz/lights_figure.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "viz/color.h"
#include "viz/heading.h"
#include "viz/legend.h"
#include "viz/scales.h"
#include "viz/signal_layer.h"

namespace sf::viz {
namespace {

using world::LightState;

// [px]
constexpr int kOwnWidth = 1600;
constexpr double kRow = 34.0;
constexpr double kBar = 22.0;  ///< height of the bar for red
constexpr double kBelow = 76.0;
constexpr double kRoomForMark = 18.0;
constexpr double kFlash = 7.0;  ///< between flashes

/// Returns the height of a state's bar relative to its row; the bar for stop is the highest.
double height_of(LightState state) {
  if (state == LightState::red || state == LightState::flashing_red) return 1.0;
  return state == LightState::green ? 0.35 : state == LightState::dark ? 0.08 : 0.65;
}

bool flashes(LightState state) { return state == LightState::flashing_red || state == LightState::flashing_yellow; }

void fill_box(Canvas& canvas, double x0, double y0, double x1, double y1, std::uint32_t color) {
  const glm::dvec2 box[] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  canvas.polygon(box, color);
}

void draw_span(Canvas& canvas, double x0, double x1, double y, LightState state) {
  const LegendItem item = signal_legend_item(state);
  const double half = 0.5 * kBar * height_of(state);
  const std::uint32_t color = with_opacity(item.color, 0.75);
  if (flashes(state))
    for (double x = x0; x < x1; x += kFlash)
      fill_box(canvas, x, y - half, std::min(x + 0.5 * kFlash, x1), y + half, color);
  else
    fill_box(canvas, x0, y - half, x1, y + half, color);
  canvas.line({x0, y - 0.5 * kBar}, {x0, y + 0.5 * kBar}, theme::kHairline, theme::kFrame);
  if (x1 - x0 > kRoomForMark) draw_signal(canvas, {0.5 * (x0 + x1), y}, 5.0, item.sample, item.color);
}

/// Draws the time axis: labels below, lines across all rows.
void draw_times(Canvas& canvas, const PixelBox& plot, double from, double to) {
  TextStyle style = small_text();
  style.across = Anchor::middle;
  style.down = Anchor::start;
  const Ticks ticks = ticks_across(from, to, plot.x_max - plot.x_min);
  for (const double time : ticks.at) {
    const double x = crisp(plot.x_min + (time - from) / (to - from) * (plot.x_max - plot.x_min));
    canvas.line({x, plot.y_min + 0.0}, {x, plot.y_max + 0.0}, theme::kHairline, theme::kGridLine);
    draw_label_across(canvas, {x, plot.y_max + 9.0}, tick_text(time, ticks));
  }
  canvas.text({0.5 * (plot.x_min + plot.x_max), plot.y_max + 36.0}, axis_name("time [s]", ticks), style);
}

std::vector<LegendItem> legend_of(std::span<const LightRow> rows) {
  std::set<LightState> seen;
  for (const LightRow& row : rows)
    for (const LightSpan& span : row.spans) seen.insert(span.state);
  std::vector<LegendItem> items;
  for (const LightState state : seen) items.push_back(signal_legend_item(state));
  return items;
}

}  // namespace

void draw_light_states(std::span<const LightRow> rows, const std::string& subtitle, const std::string& path,
                       const Page& page) {
  const int width = page_pixels(page, page.width, kOwnWidth);
  const double side = page_edge(page);
  double from = HUGE_VAL, to = -HUGE_VAL, left = 0.0;
  for (const LightRow& row : rows) {
    left = std::max(left, text_size(row.name, small_text()).x);
    for (const LightSpan& span : row.spans) from = std::min(from, span.from), to = std::max(to, span.to);
  }
  if (!(to > from)) from = std::isfinite(from) ? from - 0.5 : 0.0, to = from + 1.0;
  left = side + std::min(left, 0.4 * width) + 12.0;
  const Heading heading = make_heading("Traffic lights", subtitle, width - left - side, page);
  const PixelBox plot{static_cast<int>(left), static_cast<int>(heading.height), width - static_cast<int>(side),
                      static_cast<int>(heading.height + kRow * static_cast<double>(rows.size()))};
  const std::vector<LegendItem> legend = legend_of(rows);
  const double legend_at = legend_left(page, plot.x_min);
  const auto places = place_legend(legend, plot.x_max - legend_at);
  const int legend_rows = places.empty() ? 0 : places.back().row + 1;
  Canvas canvas(width, static_cast<int>(plot.y_max + kBelow + legend_rows * kLegendRow + side), theme::kWhite);
  draw_heading(canvas, left, heading);
  draw_times(canvas, plot, from, to);
  TextStyle style = small_text();
  style.across = Anchor::end;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = plot.y_min + kRow * (static_cast<double>(i) + 0.5);
    canvas.text({left - 10.0, y}, fitted_text(rows[i].name, style, left - side - 10.0), style);
    const auto x = [&](double time) { return plot.x_min + (time - from) / (to - from) * (plot.x_max - plot.x_min); };
    for (const LightSpan& span : rows[i].spans) draw_span(canvas, x(span.from), x(span.to), y, span.state);
  }
  draw_legend(canvas, {legend_at, plot.y_max + kBelow}, legend, places);
  save_picture(canvas.drawing(), path, page);
}

}  // namespace sf::viz
