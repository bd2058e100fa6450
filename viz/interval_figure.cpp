#include "viz/interval_figure.h"

#include <fmt/format.h>

#include <algorithm>
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

// [px]
constexpr int kIntervalWidth = 1000;
constexpr double kNarrowestPlot = 190.0;
constexpr double kWidestOfMany = 420.0;
constexpr double kPlotGap = 22.0;
constexpr double kPlotTitle = 30.0;
constexpr double kLowestIntervals = 70.0;
constexpr double kLabelsBelow = 36.0;
constexpr double kTallestLabel = 170.0;
constexpr double kNameHeight = 28.0;
constexpr double kUsualLowest = 150.0;  ///< smallest height if the page has none
constexpr double kPoint = 5.5;
constexpr double kCap = 5.0;
constexpr double kBeside = 5.0;  ///< offset between points of adjacent lines at the same x
constexpr std::uint32_t kOtherLine = 0xFFC4C8CDu;

struct Limits {
  double from = 0.0, to = 1.0;
};

/// Labels along an axis: position and text.
using AxisLabels = std::vector<std::pair<double, std::string>>;

/// Axes shared by all plots of the figure.
struct IntervalAxes {
  Limits x, y;  ///< powers of ten for a logarithmic x axis
  Ticks values;
  AxisLabels labels;  ///< along x
  Ticks unit;         ///< of the labels along x; only exponent and offset are used
  bool upright = false;
};

struct IntervalLayout {
  int width = 0, height = 0;
  Heading heading;
  IntervalAxes axes;
  std::vector<PixelBox> plots;
  std::size_t columns = 1;
  double left = 0.0, below = 0.0;   ///< [px] left end of the plots, and lower end of the x labels
  std::vector<std::string> y_name;  ///< lines
  std::vector<LegendItem> legend;
  std::vector<LegendPlace> legend_at;
};

template <class Use>
void for_each_point(const IntervalFigure& figure, Use&& use) {
  for (const IntervalPlot& plot : figure.plots)
    for (const auto* lines : {&plot.lines, &plot.others})
      for (const IntervalLine& line : *lines)
        for (const IntervalPoint& point : line.points) use(point);
}

double place_of(const IntervalFigure& figure, double x) { return figure.logarithmic ? std::log10(x) : x; }

/// Returns the distinct values of x that are drawn.
std::vector<double> shown_values(const IntervalFigure& figure) {
  std::vector<double> values;
  for_each_point(figure, [&](const IntervalPoint& p) { values.push_back(p.x); });
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

Limits x_limits(const IntervalFigure& figure) {
  if (!figure.categories.empty()) return {-0.5, static_cast<double>(figure.categories.size()) - 0.5};
  const std::vector<double> values = shown_values(figure);
  if (values.empty()) return {};
  const double from = place_of(figure, values.front()), to = place_of(figure, values.back());
  const double pad = to > from ? 0.05 * (to - from) : std::max(0.05 * std::abs(from), 0.5);
  return {from - pad, to + pad};
}

Limits y_limits(const IntervalFigure& figure) {
  if (figure.proportion) return {-0.03, 1.03};
  Limits y{HUGE_VAL, -HUGE_VAL};
  for_each_point(figure, [&](const IntervalPoint& p) {
    for (const double v : {p.mean, p.low, p.high})
      if (std::isfinite(v)) y = {std::min(y.from, v), std::max(y.to, v)};
  });
  if (y.from > y.to) return {};
  const bool zero = y.from >= 0.0 && y.from <= 0.5 * y.to;  // otherwise more than half of the axis would be empty
  if (zero) y.from = 0.0;
  const double pad = y.to > y.from ? 0.06 * (y.to - y.from) : y.to != 0.0 ? 0.05 * std::abs(y.to) : 1.0;
  return {zero ? 0.0 : y.from - pad, y.to + pad};
}

bool is_power_of_ten(double value) {
  const double power = value > 0.0 ? std::pow(10.0, std::round(std::log10(value))) : 0.0;
  return power > 0.0 && std::abs(value - power) < 1e-9 * power;
}

/// Formats with four significant digits, or all digits before the point: "0.35", "20000".
std::string plain_number(double value) {
  const double before = value == 0.0 ? 0.0 : std::floor(std::log10(std::abs(value)) + 1e-9) + 1.0;
  return fmt::format("{:.{}g}", value, static_cast<int>(std::clamp(before, 4.0, 15.0)));
}

/// Returns labels of the same form: powers of ten if all values are and some are large or small, otherwise plain
/// numbers in a common unit. Returns none if no common form exists, since the magnitudes differ too much or only the
/// last digits differ.
AxisLabels number_labels(const IntervalFigure& figure, const std::vector<double>& values, Ticks& unit) {
  constexpr double kSmall = 1.0001e-4, kLarge = 0.9999e4;
  double most = 0.0;
  std::size_t decimals = 0;
  bool extreme = false;
  for (const double value : values) {
    const std::string text = plain_number(value);
    most = std::max(most, std::abs(value));
    decimals = std::max(decimals,
                        text.find('e') != text.npos ? 9 : text.size() - 1 - std::min(text.find('.'), text.size() - 1));
    extreme = extreme || value < kSmall || value > kLarge;
  }
  const bool powers = extreme && std::all_of(values.begin(), values.end(), is_power_of_ten);
  unit = {};
  if (!powers) unit.exponent = label_exponent(most, static_cast<int>(decimals));
  AxisLabels labels;
  for (const double value : values) {
    const std::string text = powers ? power_of_ten(static_cast<int>(std::lround(std::log10(value))))
                                    : plain_number(value / std::pow(10.0, unit.exponent));
    if (text.find('e') != text.npos || (!labels.empty() && labels.back().second == with_minus(text))) return {};
    labels.emplace_back(place_of(figure, value), with_minus(text));
  }
  return labels;
}

/// True if labels centred at their values do not touch within `pixels`.
bool labels_fit(const AxisLabels& labels, const Limits& x, double pixels) {
  double last = -HUGE_VAL;
  for (const auto& [value, text] : labels) {
    const double at = (value - x.from) / (x.to - x.from) * pixels, half = 0.5 * text_size(text, small_text()).x;
    if (at - half < last + 8.0) return false;
    last = at + half;
  }
  return true;
}

/// Returns the values within the axis: 1, 2 and 5 times powers of ten, only powers of ten, or every second power and so
/// on.
std::vector<double> log_values(const Limits& x, int every) {
  std::vector<double> values;
  for (int decade = static_cast<int>(std::floor(x.from)); decade <= x.to; decade += std::max(every, 1))
    for (const double digit : every == 0 ? std::vector<double>{1.0, 2.0, 5.0} : std::vector<double>{1.0})
      if (const double at = std::log10(digit) + decade; at >= x.from && at <= x.to)
        values.push_back(digit * std::pow(10.0, decade));
  return values;
}

/// Labels as many round numbers as fit, at least two.
void label_round_numbers(const IntervalFigure& figure, double pixels, IntervalAxes& axes) {
  for (int every = 0; figure.logarithmic && every < 40; ++every) {
    axes.labels = number_labels(figure, log_values(axes.x, every), axes.unit);
    if (axes.labels.size() > 1 && labels_fit(axes.labels, axes.x, pixels)) return;
  }
  const auto value_of = [&](double place) { return figure.logarithmic ? std::pow(10.0, place) : place; };
  axes.unit = ticks_across(value_of(axes.x.from), value_of(axes.x.to), pixels);
  axes.labels.clear();
  for (const double value : axes.unit.at)
    axes.labels.emplace_back(place_of(figure, value), tick_text(value, axes.unit));
  if (figure.logarithmic && !labels_fit(axes.labels, axes.x, pixels))
    axes.labels = {axes.labels.front(), axes.labels.back()};
}

/// Labels the swept values if they fit, otherwise round numbers.
void label_x(const IntervalFigure& figure, double pixels, IntervalAxes& axes) {
  constexpr std::size_t kMostLabels = 8;
  axes.labels.clear();
  for (std::size_t i = 0; i < figure.categories.size(); ++i)
    axes.labels.emplace_back(static_cast<double>(i), figure.categories[i]);
  axes.upright = !labels_fit(axes.labels, axes.x, pixels);
  if (!figure.categories.empty()) return;
  axes.upright = false;
  axes.labels = number_labels(figure, shown_values(figure), axes.unit);
  if (axes.labels.size() < 2 || axes.labels.size() > kMostLabels || !labels_fit(axes.labels, axes.x, pixels))
    label_round_numbers(figure, pixels, axes);
}

double labels_height(const IntervalAxes& axes) {
  double tallest = 0.0;
  for (const auto& [value, text] : axes.labels) tallest = std::max(tallest, text_size(text, small_text()).x);
  return axes.upright ? std::min(tallest, kTallestLabel) + 16.0 : kLabelsBelow;
}

std::span<const double> interval_style(std::size_t row, const Page& page) {
  return page.line_styles ? line_style(row) : std::span<const double>();
}

std::vector<LegendItem> interval_legend(const IntervalFigure& figure, const Page& page) {
  std::vector<LegendItem> items;
  const std::vector<IntervalLine>& lines = figure.plots.front().lines;
  for (std::size_t row = 0; row < lines.size(); ++row) {
    const auto has_mean = [&](const IntervalPlot& plot) {
      return std::any_of(plot.lines[row].points.begin(), plot.lines[row].points.end(),
                         [](const IntervalPoint& p) { return std::isfinite(p.mean); });
    };
    if (lines[row].name.empty() || std::none_of(figure.plots.begin(), figure.plots.end(), has_mean)) continue;
    LegendItem item{LegendMark::line, row_color(row, lines.size()), lines[row].name, theme::kNone,
                    interval_style(row, page)};
    item.row = static_cast<int>(row);
    items.push_back(item);
  }
  return items;
}

/// Returns the number of columns: as many as fit, in rows of about equal length.
std::size_t columns_of(std::size_t plots, double room) {
  const auto most = static_cast<std::size_t>(std::clamp((room + kPlotGap) / (kNarrowestPlot + kPlotGap), 1.0, 6.0));
  const std::size_t rows = (plots + most - 1) / most;
  return (plots + rows - 1) / rows;
}

bool has_titles(const IntervalFigure& figure) {
  return std::any_of(figure.plots.begin(), figure.plots.end(), [](const IntervalPlot& p) { return !p.title.empty(); });
}

IntervalLayout lay_out(const IntervalFigure& figure, const Page& page) {
  IntervalLayout l;
  const double edge = page_edge(page);
  l.width = page_pixels(page, page.width, kIntervalWidth);
  l.axes.x = x_limits(figure);
  l.axes.y = y_limits(figure);
  l.legend = interval_legend(figure, page);
  double legend = 0.0;
  const double title = has_titles(figure) ? kPlotTitle : 0.0;

  double high = 300.0, wide = 0.0;
  std::size_t rows = 1;
  for (int round = 0; round < 3; ++round) {  // labels and plots depend on each other
    l.axes.values = ticks_up(l.axes.y.from, l.axes.y.to, high);
    l.y_name = name_lines(axis_name(figure.y_name, l.axes.values),
                          static_cast<double>(rows) * (high + title) + kLabelsBelow + kNameHeight);
    l.left =
        edge + 26.0 + kNameLine * (static_cast<double>(l.y_name.size()) - 1.0) + widest_label(l.axes.values) + 16.0;
    l.legend_at = place_legend(l.legend, l.width - legend_left(page, l.left) - edge);
    legend = l.legend.empty() ? 0.0 : (l.legend_at.back().row + 1) * kLegendRow + 6.0;
    const double room = l.width - l.left - edge;
    l.columns = columns_of(figure.plots.size(), room);
    rows = (figure.plots.size() + l.columns - 1) / l.columns;
    wide = (room + kPlotGap) / static_cast<double>(l.columns) - kPlotGap;
    if (figure.plots.size() > 1) wide = std::min(wide, kWidestOfMany);
    label_x(figure, wide, l.axes);
    l.heading = make_heading(figure.title, figure.subtitle, l.width - legend_left(page, l.left) - edge, page);
    const double fixed = l.heading.height + labels_height(l.axes) + kNameHeight + legend + edge;
    const auto part_of = [&](double millimetres) {
      return (page_pixels(page, millimetres, 0) - fixed + kPlotGap) / static_cast<double>(rows) - title - kPlotGap;
    };
    high = page.height > 0.0 ? part_of(page.height)
                             : std::min(std::max(0.66 * wide, kUsualLowest), part_of(kLargestColumn));
    high = std::max(high, kLowestIntervals);
  }
  for (std::size_t i = 0; i < figure.plots.size(); ++i) {
    const double x = l.left + static_cast<double>(i % l.columns) * (wide + kPlotGap);
    const double y = l.heading.height + title + static_cast<double>(i / l.columns) * (high + title + kPlotGap);
    l.plots.push_back(
        {static_cast<int>(x), static_cast<int>(y), static_cast<int>(x + wide), static_cast<int>(y + high)});
  }
  l.below = l.plots.back().y_max + labels_height(l.axes);
  l.height = static_cast<int>(l.below + kNameHeight + legend + edge);
  return l;
}

glm::dvec2 pixel_of(const IntervalFigure& figure, const IntervalAxes& axes, const PixelBox& plot, double x, double y) {
  return {plot.x_min + (place_of(figure, x) - axes.x.from) / (axes.x.to - axes.x.from) * (plot.x_max - plot.x_min),
          plot.y_max - (y - axes.y.from) / (axes.y.to - axes.y.from) * (plot.y_max - plot.y_min)};
}

/// Draws grid lines, and labels if the plot is the first of its row or the last of its column.
void draw_interval_scales(Canvas& canvas, const IntervalAxes& axes, const PixelBox& p, bool first, bool last) {
  TextStyle style = small_text();
  style.across = Anchor::end;
  for (const double value : axes.values.at) {
    const double y = crisp(p.y_max - (value - axes.y.from) / (axes.y.to - axes.y.from) * (p.y_max - p.y_min));
    canvas.line({p.x_min + 0.0, y}, {p.x_max + 0.0, y}, theme::kHairline, theme::kGridLine);
    if (first) canvas.text({p.x_min - 11.0, y}, tick_text(value, axes.values), style);
  }
  style.across = Anchor::middle;
  style.down = Anchor::start;
  style.upwards = axes.upright;
  for (const auto& [value, text] : axes.labels) {
    const double x = crisp(p.x_min + (value - axes.x.from) / (axes.x.to - axes.x.from) * (p.x_max - p.x_min));
    canvas.line({x, p.y_max + 1.0}, {x, p.y_max + 6.0}, theme::kHairline, theme::kFrame);
    if (!last) continue;
    if (axes.upright)
      canvas.text({x, p.y_max + 11.0}, fitted_text(text, small_text(), kTallestLabel), style);
    else
      draw_label_across(canvas, {x, p.y_max + 11.0}, text);
  }
}

void draw_bar(Canvas& canvas, const Line& bar, std::uint32_t color) {
  canvas.line(bar.a, bar.b, theme::kOutline, color);
  for (const glm::dvec2& end : {bar.a, bar.b})
    canvas.line(end - glm::dvec2{kCap, 0.0}, end + glm::dvec2{kCap, 0.0}, theme::kOutline, color);
}

/// Returns the points of a line [px], moved `aside` to the right of their x; nullopt if there is no mean.
std::vector<std::optional<glm::dvec2>> places_of(const IntervalFigure& figure, const IntervalAxes& axes,
                                                 const PixelBox& plot, const IntervalLine& line, double aside) {
  std::vector<std::optional<glm::dvec2>> places;
  for (const IntervalPoint& p : line.points) {
    const glm::dvec2 at = pixel_of(figure, axes, plot, p.x, p.mean) + glm::dvec2{aside, 0.0};
    places.push_back(std::isfinite(at.x + at.y) ? std::optional(at) : std::nullopt);
  }
  return places;
}

void draw_through(Canvas& canvas, const std::vector<std::optional<glm::dvec2>>& places, std::uint32_t color,
                  std::span<const double> dash) {
  std::vector<Line> lines;
  for (std::size_t i = 0; i + 1 < places.size(); ++i)
    if (places[i] && places[i + 1]) lines.push_back({*places[i], *places[i + 1]});
  canvas.lines(lines, theme::kCurve, color, dash);
}

void draw_interval_plot(Canvas& canvas, const IntervalFigure& figure, const IntervalAxes& axes,
                        const IntervalPlot& plot, const PixelBox& box, const Page& page) {
  canvas.clip({box.x_min - 8, box.y_min - 8, box.x_max + 8, box.y_max + 8});  // points on the border are not clipped
  for (const IntervalLine& line : plot.others)
    if (figure.joined) draw_through(canvas, places_of(figure, axes, box, line, 0.0), kOtherLine, {});
  for (std::size_t row = 0; row < plot.lines.size(); ++row) {
    const IntervalLine& line = plot.lines[row];
    const std::uint32_t color = row_color(row, plot.lines.size());
    const double aside = kBeside * (static_cast<double>(row) - 0.5 * (static_cast<double>(plot.lines.size()) - 1.0));
    const auto places = places_of(figure, axes, box, line, plot.lines.size() <= 7 ? aside : 0.0);
    if (figure.joined) draw_through(canvas, places, color, interval_style(row, page));
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (!places[i]) continue;
      const IntervalPoint& p = line.points[i];
      if (std::isfinite(p.low + p.high))
        draw_bar(canvas,
                 {{places[i]->x, pixel_of(figure, axes, box, p.x, p.low).y},
                  {places[i]->x, pixel_of(figure, axes, box, p.x, p.high).y}},
                 color);
      draw_marker(canvas, *places[i], kPoint, static_cast<int>(row), color);
    }
  }
  canvas.unclip();
  draw_frame(canvas, box);
  TextStyle style = small_text();
  style.bold = true;
  canvas.text({box.x_min - 0.5, box.y_min - 0.5 * kPlotTitle}, fitted_name(plot.title, style, box.x_max - box.x_min),
              style);
}

/// Centred below the plots. If it is too long, keeps only the part after its last dot.
void draw_x_name(Canvas& canvas, std::string name, const IntervalLayout& l, double edge) {
  TextStyle style = small_text();
  style.across = Anchor::middle;
  const double right = l.plots[l.columns - 1].x_max, room = l.width - 2.0 * edge;
  const auto half = [&] { return 0.5 * text_size(name, style).x; };
  const std::size_t unit = std::min(name.find(" ["), name.size());
  const std::size_t last = name.rfind('.', unit);
  if (2.0 * half() > right - l.left && last != std::string::npos) name = name.substr(last + 1);
  name = fitted_text(name, style, room);
  const double middle =
      std::clamp(0.5 * (l.left + right), edge + half(), std::max(edge + half(), l.width - edge - half()));
  canvas.text({middle, l.below + 8.0}, name, style);
}

}  // namespace

bool is_geometric(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (values.size() < 3 || !(values.front() > 0.0) || values.back() < 8.0 * values.front()) return false;
  double least = HUGE_VAL, most = 0.0;
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    least = std::min(least, values[i + 1] / values[i]);
    most = std::max(most, values[i + 1] / values[i]);
  }
  return most <= 1.5 * least;
}

void draw_intervals(const IntervalFigure& figure, const std::string& path, const Page& page) {
  SF_CHECK(!figure.plots.empty(), "a figure of intervals without a plot");
  const IntervalLayout l = lay_out(figure, page);
  Canvas canvas(l.width, l.height, theme::kWhite);
  draw_heading(canvas, legend_left(page, l.left), l.heading);
  for (std::size_t i = 0; i < l.plots.size(); ++i) {
    draw_interval_scales(canvas, l.axes, l.plots[i], i % l.columns == 0, i + l.columns >= l.plots.size());
    draw_interval_plot(canvas, figure, l.axes, figure.plots[i], l.plots[i], page);
  }
  draw_x_name(canvas, axis_name(figure.x_name, l.axes.unit), l, page_edge(page));
  const double middle = 0.5 * (l.plots.front().y_min + l.plots.back().y_max);
  double longest = 0.0;
  for (const std::string& line : l.y_name) longest = std::max(longest, text_size(line, small_text()).x);
  draw_name_up(canvas, page_edge(page), std::max(middle, l.heading.height + 0.5 * longest), l.y_name);
  draw_legend(canvas, {legend_left(page, l.left), l.below + kNameHeight}, l.legend, l.legend_at);
  save_picture(canvas.drawing(), path, page);
}

}  // namespace sf::viz
