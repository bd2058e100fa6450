#include "viz/heat_map.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "viz/color.h"
#include "viz/heading.h"
#include "viz/scales.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

// [px]
constexpr int kBarGap = 16;
constexpr int kBarWidth = 14;
constexpr int kBarShades = 128;

// The ends of the colour scale are neither black nor white, which mark cells without a range.
constexpr double kDarkest = 0.16, kLightest = 0.92;
constexpr std::uint32_t kTooNear = theme::kBlack;
constexpr std::uint32_t kNoReturn = theme::kWhite;

std::uint32_t shade(double t) { return scale_color(kDarkest + t * (kLightest - kDarkest)); }

/// The smallest and largest finite value; never equal.
struct HeatSpan {
  double from = 0.0, to = 1.0;
};

HeatSpan span_of(const HeatMap& map) {
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const auto& reading : map.readings)
    for (const double value : reading)
      if (std::isfinite(value) && value < map.limit) least = std::min(least, value), most = std::max(most, value);
  if (least > most) return {0.0, std::isfinite(map.limit) && map.limit > 0.0 ? map.limit : 1.0};
  if (least == 0.0 && most == 0.0) return {};
  const double pad = most > least ? 0.0 : map.whole ? 1.0 : 0.05 * std::abs(most);
  return {least - pad, most + pad};
}

std::uint32_t color_of(const HeatMap& map, double value, const HeatSpan& span) {
  if (std::isnan(value)) return theme::kWhite;  // below the hatching
  if (value >= map.limit || std::isinf(value)) return value < 0.0 ? kTooNear : kNoReturn;
  return shade((value - span.from) / (span.to - span.from));
}

/// Returns the reading shown by each pixel column; nullopt: hatching.
std::vector<std::optional<std::size_t>> shown_readings(const HeatMap& map, int columns, double from, double to) {
  std::vector<std::optional<std::size_t>> shown(static_cast<std::size_t>(columns));
  for (int i = 0; i < columns; ++i) {
    const double time = from + (i + 0.5) / columns * (to - from);
    const auto next = std::upper_bound(map.times.begin(), map.times.end(), time);
    if (next == map.times.begin() || time - *(next - 1) > map.longest_hold) continue;
    shown[static_cast<std::size_t>(i)] = static_cast<std::size_t>(next - map.times.begin()) - 1;
  }
  return shown;
}

/// Draws the cells of the columns [first, last), row by row.
void draw_columns(Canvas& canvas, const HeatMap& map, const PixelBox& plot, const HeatSpan& span,
                  const std::vector<std::optional<std::size_t>>& shown, std::size_t first, std::size_t last) {
  const auto rows = static_cast<int>(map.rows.size());
  std::vector<std::uint32_t> colors;
  for (std::size_t row = 0; row < map.rows.size(); ++row)
    for (std::size_t i = first; i < last; ++i) colors.push_back(color_of(map, map.readings[*shown[i]][row], span));
  canvas.image({plot.x_min + static_cast<double>(first), plot.y_min + 0.0},
               {plot.x_min + static_cast<double>(last), plot.y_max + 0.0},
               {static_cast<int>(last - first), rows, colors});
}

/// Hatches cells without a value.
void hatch_missing(Canvas& canvas, const HeatMap& map, const PixelBox& plot,
                   const std::vector<std::optional<std::size_t>>& shown) {
  const double high = (plot.y_max - plot.y_min) / static_cast<double>(map.rows.size());
  for (std::size_t row = 0; row < map.rows.size(); ++row) {
    const auto missing = [&](std::size_t i) { return shown[i] && std::isnan(map.readings[*shown[i]][row]); };
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const std::size_t first = i;
      while (i < shown.size() && missing(i)) ++i;
      if (i > first)
        draw_hatching(canvas, {plot.x_min + static_cast<double>(first), plot.y_min + static_cast<double>(row) * high},
                      {plot.x_min + static_cast<double>(i), plot.y_min + (static_cast<double>(row) + 1.0) * high});
    }
  }
}

void draw_rows(Canvas& canvas, const HeatMap& map, const PixelBox& plot) {
  TextStyle style = small_text();
  style.across = Anchor::end;
  const double high = (plot.y_max - plot.y_min) / std::max(1.0, static_cast<double>(map.rows.size()));
  const auto every = static_cast<std::size_t>(std::max(1.0, std::ceil(20.0 / high)));
  for (std::size_t row = 0; row < map.rows.size(); row += every) {
    const double y = plot.y_min + (static_cast<double>(row) + 0.5) * high;
    canvas.line({plot.x_min - 6.0, crisp(y)}, {plot.x_min - 1.0, crisp(y)}, theme::kHairline, theme::kFrame);
    canvas.text({plot.x_min - 11.0, y}, map.rows[row], style);
  }
}

Ticks bar_ticks(const HeatMap& map, const HeatSpan& span, double height) {
  return ticks_up(span.from, span.to, height, map.whole);
}

void draw_bar(Canvas& canvas, const HeatMap& map, const PixelBox& plot, const HeatSpan& span) {
  const PixelBox bar{plot.x_max + kBarGap, plot.y_min, plot.x_max + kBarGap + kBarWidth, plot.y_max};
  std::vector<std::uint32_t> colors;
  for (int i = 0; i < kBarShades; ++i) colors.push_back(shade(1.0 - static_cast<double>(i) / (kBarShades - 1)));
  canvas.image({bar.x_min + 0.0, bar.y_min + 0.0}, {bar.x_max + 0.0, bar.y_max + 0.0}, {1, kBarShades, colors});
  draw_frame(canvas, bar);
  const Ticks ticks = bar_ticks(map, span, bar.y_max - bar.y_min);
  for (const double value : ticks.at) {
    const double y = crisp(bar.y_max - (value - span.from) / (span.to - span.from) * (bar.y_max - bar.y_min));
    canvas.line({bar.x_max + 1.0, y}, {bar.x_max + 6.0, y}, theme::kHairline, theme::kFrame);
    canvas.text({bar.x_max + 10.0, y}, tick_text(value, ticks), small_text());
  }
  TextStyle style = small_text();
  style.across = Anchor::middle;
  style.upwards = true;
  const std::string name = fitted_text(axis_name(map.value_name, ticks), small_text(), bar.y_max - bar.y_min + 24.0);
  const double middle = std::max(0.5 * (bar.y_min + bar.y_max), bar.y_min + 0.5 * text_size(name, small_text()).x);
  canvas.text({bar.x_max + widest_label(ticks) + 28.0, middle}, name, style);
}

template <class Is>
bool has(const HeatMap& map, Is&& is) {
  return std::any_of(map.readings.begin(), map.readings.end(),
                     [&](const auto& r) { return std::any_of(r.begin(), r.end(), is); });
}

bool has_gaps(const HeatMap& map, double from, double to) {
  if (has(map, [](double value) { return std::isnan(value); })) return true;
  const auto shown = shown_readings(map, 400, from, to);
  return std::find(shown.begin(), shown.end(), std::nullopt) != shown.end();
}

}  // namespace

double rows_room(const HeatMap& map) {
  double widest = 0.0;
  for (const std::string& row : map.rows) widest = std::max(widest, text_size(row, small_text()).x);
  return widest;
}

double bar_room(const HeatMap& map, double height) {
  return kBarGap + kBarWidth + widest_label(bar_ticks(map, span_of(map), height)) + 40.0;
}

std::vector<LegendItem> heat_legend(const HeatMap& map, double from, double to) {
  std::vector<LegendItem> items;
  if (has(map, [](double value) { return value == -HUGE_VAL; }))
    items.push_back({LegendMark::block, kTooNear, map.too_near, theme::kFrame});
  if (has(map, [&](double value) { return value >= map.limit; }))
    items.push_back({LegendMark::block, kNoReturn, map.no_return, theme::kFrame});
  if (has_gaps(map, from, to)) items.push_back({LegendMark::hatched, theme::kNoReading, "no reading"});
  return items;
}

void draw_heat_map(Canvas& canvas, const HeatMap& map, const PixelBox& plot, double from, double to) {
  const HeatSpan span = span_of(map);
  const auto shown = shown_readings(map, std::max(1, plot.x_max - plot.x_min), from, to);
  canvas.clip(plot);
  draw_hatching(canvas, {plot.x_min + 0.0, plot.y_min + 0.0}, {plot.x_max + 0.0, plot.y_max + 0.0});
  for (std::size_t first = 0; first < shown.size();) {
    std::size_t last = first;
    while (last < shown.size() && shown[last].has_value() == shown[first].has_value()) ++last;
    if (shown[first] && !map.rows.empty()) draw_columns(canvas, map, plot, span, shown, first, last);
    first = last;
  }
  hatch_missing(canvas, map, plot, shown);
  canvas.unclip();
  draw_rows(canvas, map, plot);
  draw_bar(canvas, map, plot, span);
}

}  // namespace sf::viz
