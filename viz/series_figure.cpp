#include "viz/series_figure.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "viz/canvas.h"
#include "viz/color.h"
#include "viz/heading.h"
#include "viz/legend.h"
#include "viz/theme.h"
#include "viz/ticks.h"

namespace sf::viz {
namespace {

constexpr std::size_t kNamed = 7;

// [px]
constexpr double kSeriesEdge = 26.0;
constexpr double kPanelTitle = 34.0;      ///< above each plot
constexpr double kSeriesTicks = 68.0;     ///< labels and the axis' name, below the last plot
constexpr double kSeriesAxisName = 34.0;  ///< left of the labels
constexpr double kSmallestTick = 60.0;
constexpr double kLowestPlot = 120.0;
constexpr double kLoneDot = 2.2;
constexpr double kSmallestMove = 0.3;  ///< shorter steps of a curve are left out

struct Span {
  double from = 0.0, to = 1.0;
};

/// One panel on the picture.
struct SeriesPlot {
  PixelBox plot;
  Span time;   ///< [s]
  Span shown;  ///< of the values
  std::vector<LegendItem> legend;
  std::vector<LegendPlace> legend_at;
  double legend_top = 0.0;

  glm::dvec2 pixel(double t, double value) const {
    return {plot.x_min + (t - time.from) / (time.to - time.from) * (plot.x_max - plot.x_min),
            plot.y_max - (value - shown.from) / (shown.to - shown.from) * (plot.y_max - plot.y_min)};
  }
};

template <class Take>
void widen(std::optional<Span>& span, const std::vector<double>& numbers, Take&& take) {
  for (const double number : numbers) {
    if (!take(number)) continue;
    span = span ? Span{std::min(span->from, number), std::max(span->to, number)} : Span{number, number};
  }
}

/// Extends the span to 0 unless more than half of the axis would be empty.
Span with_zero(Span span) {
  if (span.from > 0.0 && span.from <= 0.5 * span.to) span.from = 0.0;
  return span;
}

Span time_span(const SeriesOptions& options) {
  std::optional<Span> span;
  for (const Panel& panel : options.panels)
    for (const Series& series : panel.series) widen(span, series.times, [](double t) { return std::isfinite(t); });
  if (!span) return {0.0, 1.0};
  if (!(span->to > span->from)) return {span->from - 0.5, span->to + 0.5};
  return options.from_zero ? with_zero(*span) : *span;
}

/// The span of a panel's values with a margin, never empty.
Span value_span(const Panel& panel, bool from_zero) {
  std::optional<Span> span;
  for (const Series& series : panel.series) widen(span, series.values, [](double v) { return std::isfinite(v); });
  if (!span) return {0.0, 1.0};
  if (panel.from_zero) span->from = std::min(span->from, 0.0);
  if (from_zero) span = with_zero(*span);
  const double size = span->to - span->from;
  const double pad = size > 0.0 ? 0.06 * size : std::max(0.05 * std::abs(span->from), 1e-12);
  if ((from_zero || panel.from_zero) && span->from == 0.0) return {0.0, span->to + pad};
  return {span->from - pad, span->to + pad};
}

/// Rows of the named series: all, or seven from the first to the last.
std::vector<std::size_t> named_rows(std::size_t count) {
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < std::min(count, kNamed); ++k)
    rows.push_back(count <= kNamed ? k : k * (count - 1) / (kNamed - 1));
  return rows;
}

/// [px] smallest distance of labels along an axis of values.
double value_step(double height) { return std::min(kSmallestTick, height / 3.0); }

double widest_label(const Span& shown, double height) {
  const Ticks ticks = make_ticks(shown.from, shown.to, value_step(height) / height * (shown.to - shown.from));
  double widest = 0.0;
  for (const double value : ticks.at)
    widest = std::max(widest, text_size(tick_text(value, ticks.decimals), small_text()).x);
  return widest;
}

double plot_height(std::size_t panels) { return panels == 1 ? 620.0 : panels == 2 ? 420.0 : 300.0; }

/// One legend below both then suffices.
bool same_names(const Panel& a, const Panel& b) {
  return std::equal(a.series.begin(), a.series.end(), b.series.begin(), b.series.end(),
                    [](const Series& one, const Series& other) { return one.name == other.name; });
}

/// The picture's width, its heading, and its panels.
struct SeriesLayout {
  int width = 0;
  Heading heading;
  std::vector<SeriesPlot> places;
};

/// [px] left end of the plots, right of the widest label.
double plots_left(const SeriesOptions& options, double height) {
  double widest = 0.0;
  for (const Panel& panel : options.panels)
    widest = std::max(widest, widest_label(value_span(panel, options.from_zero), height));
  return widest + kSeriesEdge + kSeriesAxisName + 14.0;
}

/// [px] height of one plot on a page of a given height.
double plot_height(const SeriesOptions& options, const Page& page, double heading) {
  if (!(page.height > 0.0)) return plot_height(options.panels.size());
  const double room = page_pixels(page.height, 0) - heading - kSeriesTicks - kSeriesEdge;
  return std::max(kLowestPlot, room / static_cast<double>(options.panels.size()) - kPanelTitle - kLegendRow - 34.0);
}

SeriesLayout lay_out(const SeriesOptions& options, const Page& page) {
  SeriesLayout layout;
  layout.width = page_pixels(page.width, options.width);
  double left = plots_left(options, plot_height(options.panels.size()));
  layout.heading = make_heading(options.title, options.subtitle, layout.width - left - kSeriesEdge, page);
  const double height = plot_height(options, page, layout.heading.height);
  left = plots_left(options, height);

  std::vector<SeriesPlot>& places = layout.places;
  double top = layout.heading.height;
  for (const Panel& panel : options.panels) {
    SeriesPlot& place = places.emplace_back();
    place.time = time_span(options);
    place.shown = value_span(panel, options.from_zero);
    if (!panel.title.empty()) top += kPanelTitle;
    place.plot = {static_cast<int>(left), static_cast<int>(top), layout.width - static_cast<int>(kSeriesEdge),
                  static_cast<int>(top + height)};
    const bool last = &panel == &options.panels.back();
    for (const std::size_t row : named_rows(panel.series.size()))
      if (last || !same_names(panel, *(&panel + 1)))
        place.legend.push_back({LegendMark::line, row_color(row, panel.series.size()), panel.series[row].name});
    place.legend_at = place_legend(place.legend, place.plot.x_max - place.plot.x_min);
    place.legend_top = place.plot.y_max + (last ? kSeriesTicks + 8.0 : 20.0);
    const int rows = place.legend_at.empty() ? 0 : place.legend_at.back().row + 1;
    top = place.legend_top + rows * kLegendRow + 14.0;
  }
  return layout;
}

Ticks ticks_of(const Span& span, double pixels, double smallest) {
  return make_ticks(span.from, span.to, smallest / pixels * (span.to - span.from));
}

/// @param x_name name of the axis; empty: neither name nor labels
void draw_series_scales(Canvas& canvas, const SeriesPlot& at, const std::string& x_name) {
  const PixelBox& p = at.plot;
  TextStyle style = small_text();
  style.across = Anchor::end;
  const Ticks values = ticks_of(at.shown, p.y_max - p.y_min, value_step(p.y_max - p.y_min));
  for (const double value : values.at) {
    const double y = crisp(at.pixel(at.time.from, value).y);
    canvas.line({p.x_min + 0.0, y}, {p.x_max + 0.0, y}, theme::kHairline, theme::kGridLine);
    canvas.text({p.x_min - 11.0, y}, tick_text(value, values.decimals), style);
  }
  style.across = Anchor::middle;
  style.down = Anchor::start;
  const Ticks times = ticks_of(at.time, p.x_max - p.x_min, 110.0);
  for (const double time : times.at) {
    const double x = crisp(at.pixel(time, at.shown.from).x);
    canvas.line({x, p.y_min + 0.0}, {x, p.y_max + 0.0}, theme::kHairline, theme::kGridLine);
    if (!x_name.empty()) canvas.text({x, p.y_max + 11.0}, tick_text(time, times.decimals), style);
  }
  if (!x_name.empty()) canvas.text({0.5 * (p.x_min + p.x_max), p.y_max + 42.0}, x_name, style);
}

void draw_curve(Canvas& canvas, const SeriesPlot& at, const Series& series, std::uint32_t color) {
  std::vector<Line> lines;
  std::optional<glm::dvec2> last;
  const auto known = [&](std::size_t i) {
    return i < series.values.size() && std::isfinite(series.values[i]) && std::isfinite(series.times[i]);
  };
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    if (!known(i)) {
      last.reset();
      continue;
    }
    const glm::dvec2 here = at.pixel(series.times[i], series.values[i]);
    if (!last && !known(i + 1)) canvas.disc(here, kLoneDot, color);
    if (last && length(here - *last) < kSmallestMove && known(i + 1)) continue;
    lines.push_back({last.value_or(here), here});
    last = here;
  }
  canvas.lines(lines, theme::kCurve, color);
}

void draw_panel(Canvas& canvas, const Panel& panel, const SeriesPlot& at, const std::string& x_name) {
  draw_series_scales(canvas, at, x_name);
  canvas.clip(at.plot);
  for (std::size_t i = 0; i < panel.series.size(); ++i)
    draw_curve(canvas, at, panel.series[i], row_color(i, panel.series.size()));
  canvas.unclip();

  const double x0 = at.plot.x_min - 0.5, y0 = at.plot.y_min - 0.5, x1 = at.plot.x_max + 0.5, y1 = at.plot.y_max + 0.5;
  const glm::dvec2 corners[] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}};
  canvas.polyline(corners, theme::kHairline, theme::kFrame);
  TextStyle style = small_text();
  style.bold = true;
  canvas.text({x0, y0 - 0.5 * kPanelTitle}, panel.title, style);
  style.bold = false;
  style.across = Anchor::middle;
  style.upwards = true;
  canvas.text({38.0, 0.5 * (y0 + y1)}, panel.y_name, style);
  draw_legend(canvas, {at.plot.x_min + 0.0, at.legend_top}, at.legend, at.legend_at);
}

}  // namespace

void draw_series(const SeriesOptions& options, const std::string& path, const Page& page) {
  SF_CHECK(!options.panels.empty() && options.panels.size() <= 16, std::to_string(options.panels.size()) + " panels");
  SF_CHECK(options.width >= 600 && options.width <= 8000, "width " + std::to_string(options.width) + " px");
  for (const Panel& panel : options.panels)
    for (const Series& series : panel.series)
      SF_CHECK(series.times.size() == series.values.size(), "series " + series.name + " has " +
                                                                std::to_string(series.times.size()) + " times for " +
                                                                std::to_string(series.values.size()) + " values");

  const SeriesLayout layout = lay_out(options, page);
  const std::vector<SeriesPlot>& places = layout.places;
  const SeriesPlot& last = places.back();
  const int rows = last.legend_at.empty() ? 0 : last.legend_at.back().row + 1;
  Canvas canvas(layout.width, static_cast<int>(last.legend_top + rows * kLegendRow + kSeriesEdge), theme::kWhite);
  draw_heading(canvas, last.plot.x_min, layout.heading);
  for (std::size_t i = 0; i < places.size(); ++i)
    draw_panel(canvas, options.panels[i], places[i], i + 1 == places.size() ? options.x_name : "");
  save_picture(canvas.drawing(), path, page);
}

}  // namespace sf::viz
