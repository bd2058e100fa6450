#include "viz/series_figure.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "viz/canvas.h"
#include "viz/color.h"
#include "viz/heading.h"
#include "viz/legend.h"
#include "viz/scales.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

constexpr std::size_t kNamed = 7;

// [px]
constexpr double kPanelTitle = 34.0;      ///< above each plot
constexpr double kSeriesTicks = 68.0;     ///< labels and name of the axis, below the last plot
constexpr double kSeriesAxisName = 34.0;  ///< left of the labels
constexpr double kLowestPlot = 70.0;
constexpr double kNameBelow = 24.0;   ///< maximum extension of an axis name below its plot
constexpr double kTitleLifted = 4.0;  ///< above the labels of its axis
constexpr double kLoneDot = 2.2;
constexpr double kSmallestMove = 0.3;  ///< shorter steps of a curve are skipped

struct Span {
  double from = 0.0, to = 1.0;
};

/// Layout of one panel.
struct SeriesPlot {
  PixelBox plot;
  Span time;                 ///< [s]
  Span shown;                ///< of the values
  bool logarithmic = false;  ///< all numbers are logarithms
  std::vector<LegendItem> legend;
  std::vector<LegendPlace> legend_at;
  double legend_top = 0.0;
  std::vector<std::string> y_name;  ///< lines

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

/// Returns the span of whole decades around it.
Span decades(const std::optional<Span>& span) {
  if (!span) return {0.0, 1.0};
  const double from = std::floor(span->from);
  return {from, std::max(std::ceil(span->to), from + 1.0)};
}

Span time_span(const SeriesOptions& options) {
  std::optional<Span> span;
  for (const Panel& panel : options.panels) {
    if (panel.map) widen(span, panel.map->times, [](double t) { return std::isfinite(t); });
    for (const Series& series : panel.series) widen(span, series.times, [](double t) { return std::isfinite(t); });
  }
  if (!span || options.logarithmic) return decades(span);
  if (!(span->to > span->from)) return {span->from - 0.5, span->to + 0.5};
  return options.from_zero ? with_zero(*span) : *span;
}

/// Returns ticks of an axis along y, or along x.
Ticks ticks_of(const Span& span, double pixels, bool whole, bool logarithmic, bool up) {
  Ticks ticks = (up ? ticks_up : ticks_across)(span.from, span.to, pixels, whole || logarithmic);
  ticks.powers = logarithmic;
  return ticks;
}

/// Returns the span of a panel's values with a margin; never empty.
Span value_span(const Panel& panel, bool from_zero, bool logarithmic) {
  std::optional<Span> span;
  for (const Series& series : panel.series) widen(span, series.values, [](double v) { return std::isfinite(v); });
  if (!span || logarithmic) return decades(span);
  if (panel.from_zero) span->from = std::min(span->from, 0.0);
  if (from_zero) span = with_zero(*span);
  const double size = span->to - span->from;
  if (panel.whole && size == 0.0) return {span->from - 0.1, span->from + 1.1};  // contains two integers
  const double pad = size > 0.0 ? 0.06 * size : span->from != 0.0 ? 0.05 * std::abs(span->from) : 1.0;
  if ((from_zero || panel.from_zero) && span->from == 0.0) return {0.0, span->to + pad};
  return {span->from - pad, span->to + pad};
}

bool has_value(const Series& series) {
  return std::any_of(series.values.begin(), series.values.end(), [](double v) { return std::isfinite(v); });
}

/// Returns the rows of the named series: all if there are up to eight, otherwise seven from the first to the last.
std::vector<std::size_t> named_rows(const Panel& panel) {
  std::vector<std::size_t> drawn, rows;
  for (std::size_t row = 0; row < panel.series.size(); ++row)
    if (has_value(panel.series[row])) drawn.push_back(row);
  const std::size_t count = drawn.size();
  if (count <= kNamed + 1) return drawn;  // the place of "and 1 more"
  for (std::size_t k = 0; k < kNamed; ++k) rows.push_back(drawn[k * (count - 1) / (kNamed - 1)]);
  return rows;
}

double plot_height(std::size_t panels) { return panels == 1 ? 620.0 : panels == 2 ? 420.0 : 300.0; }

std::span<const double> style_of(std::size_t row, const Page& page) {
  return page.line_styles ? line_style(row) : std::span<const double>();
}

/// Returns the legend items of a panel.
std::vector<LegendItem> legend_of(const Panel& panel, const Span& time, const Page& page) {
  if (panel.map) return heat_legend(*panel.map, time.from, time.to);
  std::vector<LegendItem> items;
  const std::vector<std::size_t> named = named_rows(panel);
  for (const std::size_t row : named)
    items.push_back({LegendMark::line, row_color(row, panel.series.size()), panel.series[row].name, theme::kNone,
                     style_of(row, page)});
  const auto drawn = static_cast<std::size_t>(std::count_if(panel.series.begin(), panel.series.end(), has_value));
  if (named.size() < drawn) items.push_back(more_item(drawn - named.size()));
  return items;
}

/// If true, one legend below both is enough.
bool same_legend(const std::vector<LegendItem>& a, const std::vector<LegendItem>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const LegendItem& one, const LegendItem& other) {
    return one.sample == other.sample && one.color == other.color && one.text == other.text;
  });
}

/// Width of the picture, heading and panels.
struct SeriesLayout {
  int width = 0;
  Heading heading;
  std::vector<SeriesPlot> places;
};

/// Returns the lines of a panel's axis name. The name may extend into the gap below the plot.
std::vector<std::string> y_lines(const Panel& panel, const Span& shown, double height, bool logarithmic) {
  if (panel.map) return name_lines(panel.y_name, height + kNameBelow);
  const Ticks ticks = ticks_of(shown, height, panel.whole, logarithmic, true);
  return name_lines(axis_name(panel.y_name, ticks), height + kNameBelow);
}

/// [px] Returns the left end of the plots, right of the widest label.
double plots_left(const SeriesOptions& options, double height, double edge) {
  double widest = 0.0;
  std::size_t lines = 1;
  for (const Panel& panel : options.panels) {
    const Span span = value_span(panel, options.from_zero, options.logarithmic);
    lines = std::max(lines, y_lines(panel, span, height, options.logarithmic).size());
    widest = std::max(widest, panel.map ? rows_room(*panel.map)
                                        : widest_label(ticks_of(span, height, panel.whole, options.logarithmic, true)));
  }
  return widest + edge + kSeriesAxisName + kNameLine * (static_cast<double>(lines) - 1.0) + 14.0;
}

/// [px] Returns the space right of the plots.
double plots_right(const SeriesOptions& options, double height, double edge) {
  double room = edge;
  for (const Panel& panel : options.panels)
    if (panel.map) room = std::max(room, edge + bar_room(*panel.map, height) - 12.0);
  return room;
}

/// [px] Returns the height of one plot, given by the page height, or in proportion to a narrow page up to the height of
/// a column.
/// @param width of the plots
double plot_height(const SeriesOptions& options, const Page& page, double heading, double width) {
  const auto panels = static_cast<double>(options.panels.size());
  const auto part_of = [&](double millimetres) {
    const double room = page_pixels(page, millimetres, 0) - heading - kSeriesTicks - page_edge(page);
    return std::max(kLowestPlot, room / panels - kPanelTitle - kLegendRow - 34.0);
  };
  if (page.height > 0.0) return part_of(page.height);
  const double own = plot_height(options.panels.size());
  if (!(page.width > 0.0)) return own;
  return std::min({own, std::max(0.62 * width, 2.0 * kLowestPlot), part_of(kLargestColumn)});
}

/// [px] Returns the height of the picture.
double picture_height(const SeriesLayout& layout, double edge) {
  const SeriesPlot& last = layout.places.back();
  const int rows = last.legend_at.empty() ? 0 : last.legend_at.back().row + 1;
  return last.legend_top + rows * kLegendRow + edge;
}

/// Places the panels, each with a plot of `height` [px] from `left` to `right`.
void place_panels(SeriesLayout& layout, const SeriesOptions& options, const Page& page, double height) {
  const double edge = page_edge(page), left = plots_left(options, height, edge);
  const double right = layout.width - plots_right(options, height, edge);
  const Span time = time_span(options);
  std::vector<std::vector<LegendItem>> legends;
  for (const Panel& panel : options.panels) legends.push_back(legend_of(panel, time, page));
  std::vector<SeriesPlot>& places = layout.places;
  places.clear();
  double top = layout.heading.height;
  for (std::size_t i = 0; i < options.panels.size(); ++i) {
    SeriesPlot& place = places.emplace_back();
    place.time = time;
    place.shown = value_span(options.panels[i], options.from_zero, options.logarithmic);
    place.logarithmic = options.logarithmic;
    if (!options.panels[i].title.empty()) top += kPanelTitle;
    place.plot = {static_cast<int>(left), static_cast<int>(top), static_cast<int>(right),
                  static_cast<int>(top + height)};
    const bool last = i + 1 == options.panels.size();
    if (last || !same_legend(legends[i], legends[i + 1])) place.legend = legends[i];
    place.y_name = y_lines(options.panels[i], place.shown, height, options.logarithmic);
    place.legend_at = place_legend(place.legend, layout.width - edge - legend_left(page, left));
    place.legend_top = place.plot.y_max + (last ? kSeriesTicks + 8.0 : 20.0);
    const int rows = place.legend_at.empty() ? 0 : place.legend_at.back().row + 1;
    top = place.legend_top + rows * kLegendRow + 14.0;
  }
}

/// Replaces all numbers by their logarithms.
SeriesOptions with_logarithms(SeriesOptions options) {
  for (Panel& panel : options.panels)
    for (Series& series : panel.series)
      for (std::vector<double>* numbers : {&series.times, &series.values})
        for (double& number : *numbers) number = number > 0.0 ? std::log10(number) : NAN;
  return options;
}

/// Uses the short row labels of heat maps if the long ones would take half of the picture.
SeriesOptions with_fitting_rows(SeriesOptions options, const Page& page) {
  const double edge = page_edge(page), width = page_pixels(page, page.width, options.width);
  const double height = plot_height(options.panels.size());
  if (width - plots_left(options, height, edge) - plots_right(options, height, edge) > 0.5 * width) return options;
  for (Panel& panel : options.panels) {
    if (!panel.map || panel.map->short_rows.empty()) continue;
    panel.map->rows = panel.map->short_rows;
    panel.y_name = panel.map->short_name;
  }
  return options;
}

SeriesLayout lay_out(const SeriesOptions& options, const Page& page) {
  const double edge = page_edge(page);
  SeriesLayout layout;
  layout.width = page_pixels(page, page.width, options.width);
  double height = plot_height(options.panels.size());
  for (int round = 0; round < 3; ++round) {  // labels, heading and plots depend on each other
    const double left = plots_left(options, height, edge), right = layout.width - plots_right(options, height, edge);
    layout.heading = make_heading(options.title, options.subtitle, layout.width - legend_left(page, left) - edge, page);
    height = plot_height(options, page, layout.heading.height, right - left);
  }
  place_panels(layout, options, page, height);
  if (!(page.height > 0.0)) return layout;
  // The heights of legends and titles are now known.
  const double more = page_pixels(page, page.height, 0) - picture_height(layout, edge);
  height = std::max(kLowestPlot, height + std::floor(more / static_cast<double>(options.panels.size())));
  place_panels(layout, options, page, height);
  return layout;
}

void draw_values(Canvas& canvas, const Panel& panel, const SeriesPlot& at) {
  const PixelBox& p = at.plot;
  TextStyle style = small_text();
  style.across = Anchor::end;
  const Ticks values = ticks_of(at.shown, p.y_max - p.y_min, panel.whole, at.logarithmic, true);
  for (const double value : values.at) {
    const double y = crisp(at.pixel(at.time.from, value).y);
    canvas.line({p.x_min + 0.0, y}, {p.x_max + 0.0, y}, theme::kHairline, theme::kGridLine);
    canvas.text({p.x_min - 11.0, y}, tick_text(value, values), style);
  }
}

/// @param x_name name of the axis; empty: neither name nor labels
void draw_times(Canvas& canvas, const SeriesPlot& at, const std::string& x_name, bool grid) {
  const PixelBox& p = at.plot;
  TextStyle style = small_text();
  style.across = Anchor::middle;
  style.down = Anchor::start;
  const Ticks times = ticks_of(at.time, p.x_max - p.x_min, false, at.logarithmic, false);
  for (const double time : times.at) {
    const double x = crisp(at.pixel(time, at.shown.from).x);
    if (grid)
      canvas.line({x, p.y_min + 0.0}, {x, p.y_max + 0.0}, theme::kHairline, theme::kGridLine);
    else
      canvas.line({x, p.y_max + 1.0}, {x, p.y_max + 6.0}, theme::kHairline, theme::kFrame);
    if (!x_name.empty()) draw_label_across(canvas, {x, p.y_max + 11.0}, tick_text(time, times));
  }
  if (!x_name.empty()) canvas.text({0.5 * (p.x_min + p.x_max), p.y_max + 42.0}, axis_name(x_name, times), style);
}

/// @param steps each value lasts until the next one
void draw_curve(Canvas& canvas, const SeriesPlot& at, const Series& series, bool steps, std::uint32_t color,
                std::span<const double> dash) {
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
    if (steps && last) {
      const glm::dvec2 corner{here.x, last->y};
      lines.push_back({*last, corner});
      if (corner.y != here.y) lines.push_back({corner, here});
    } else {
      lines.push_back({last.value_or(here), here});
    }
    last = here;
  }
  canvas.lines(lines, theme::kCurve, color, dash);
}

void draw_panel(Canvas& canvas, const Panel& panel, const SeriesPlot& at, const std::string& x_name, const Page& page) {
  if (!panel.map) draw_values(canvas, panel, at);
  draw_times(canvas, at, x_name, !panel.map);
  if (panel.map) draw_heat_map(canvas, *panel.map, at.plot, at.time.from, at.time.to);
  canvas.clip(at.plot);
  for (std::size_t i = 0; i < panel.series.size(); ++i)
    draw_curve(canvas, at, panel.series[i], panel.whole, row_color(i, panel.series.size()), style_of(i, page));
  canvas.unclip();

  draw_frame(canvas, at.plot);
  TextStyle style = small_text();
  style.bold = true;
  const double edge = page_edge(page), room = canvas.width() - edge - at.plot.x_min;
  const bool above_labels = text_size(panel.title, style).x > room;
  const double left = above_labels ? edge : at.plot.x_min - 0.5;
  canvas.text({left, at.plot.y_min - 0.5 - 0.5 * kPanelTitle - (above_labels ? kTitleLifted : 0.0)},
              fitted_name(panel.title, style, canvas.width() - edge - left), style);
  double longest = 0.0;
  for (const std::string& line : at.y_name) longest = std::max(longest, text_size(line, small_text()).x);
  const double middle = 0.5 * (at.plot.y_min + at.plot.y_max);
  draw_name_up(canvas, edge, above_labels ? std::max(middle, at.plot.y_min + 0.5 * longest) : middle, at.y_name);
  draw_legend(canvas, {legend_left(page, at.plot.x_min), at.legend_top}, at.legend, at.legend_at);
}

}  // namespace

void draw_series(const SeriesOptions& wanted, const std::string& path, const Page& page) {
  const SeriesOptions options = with_fitting_rows(wanted.logarithmic ? with_logarithms(wanted) : wanted, page);
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
  Canvas canvas(layout.width, static_cast<int>(picture_height(layout, page_edge(page))), theme::kWhite);
  draw_heading(canvas, legend_left(page, last.plot.x_min), layout.heading);
  for (std::size_t i = 0; i < places.size(); ++i)
    draw_panel(canvas, options.panels[i], places[i], i + 1 == places.size() ? options.x_name : "", page);
  save_picture(canvas.drawing(), path, page);
}

}  // namespace sf::viz
