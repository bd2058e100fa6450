#include "viz/tradeoff_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "viz/canvas.h"
#include "viz/color.h"
#include "viz/heading.h"
#include "viz/labels.h"
#include "viz/legend.h"
#include "viz/scales.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

// [px]
constexpr int kTradeoffWidth = 1400;
constexpr int kTradeoffLeft = 124;       ///< plus the page's edge
constexpr int kTradeoffRight = 14;       ///< plus the page's edge
constexpr double kErrorNameLine = 24.0;  ///< line height of axis names with several lines
constexpr int kPlot = 400;
constexpr int kLowestPanel = 120;
constexpr int kBetween = 150;            ///< between panels, for a title and the labels below a plot
constexpr double kNothing = 120.0;       ///< column for errors of 0: at most a quarter of the plot,
constexpr double kLeastNothing = 104.0;  ///< but wide enough for its label and that of the next power of ten

/// Smaller errors are rounding errors and count as 0.
constexpr double kLeast = 1e-12;

/// The range of powers of ten that contains the values.
struct Decades {
  int from = 0, to = 1;
};

Decades decades_of(const std::vector<TradeoffPoint>& points) {
  double least = HUGE_VAL, most = 0.0;
  for (const TradeoffPoint& point : points)
    for (const double v : {point.low, point.middle, point.high, point.covered.high, point.covered.bound}) {
      if (!(v >= kLeast) || std::isinf(v)) continue;
      least = std::min(least, v);
      most = std::max(most, v);
    }
  if (!(most > 0.0)) return {-9, -8};
  const int from = static_cast<int>(std::floor(std::log10(least) - 0.05));
  return {from, std::max(from + 1, static_cast<int>(std::ceil(std::log10(most) + 0.05)))};
}

struct PlotArea {
  PixelBox plot;
  Decades error;
  double edge = 0.0;     ///< [px] of the page
  double fastest = 1.0;  ///< [1/s] upper end of the axis; the lower end is 0

  double nothing() const { return std::clamp(0.25 * (plot.x_max - plot.x_min), kLeastNothing, kNothing); }
  double x(double error_value) const {
    if (!(error_value >= kLeast)) return plot.x_min + 0.5 * nothing();
    if (std::isinf(error_value)) return plot.x_max;
    const double part = (std::log10(error_value) - error.from) / (error.to - error.from);
    return plot.x_min + nothing() + part * (plot.x_max - plot.x_min - nothing());
  }
  double y(double value) const { return plot.y_max - value / fastest * (plot.y_max - plot.y_min); }
};

/// "40 M", "5 k", "0".
std::string rate_text(double rate) {
  if (rate >= 1e6) return fmt::format("{:g} M", rate * 1e-6);
  if (rate >= 1e3) return fmt::format("{:g} k", rate * 1e-3);
  return fmt::format("{:g}", std::abs(rate));  // no -0
}

/// Returns the powers of ten per label, for two to twelve labels.
int decades_apart(const PlotArea& at) {
  constexpr double kUsual = 100.0, kGap = 6.0;  // [px]
  const int all = at.error.to - at.error.from;
  const double room = at.plot.x_max - at.plot.x_min - at.nothing();
  const double widest = std::max(text_size(power_of_ten(at.error.from), small_text()).x,
                                 text_size(power_of_ten(at.error.to), small_text()).x);
  const int apart = static_cast<int>(std::ceil((room >= kUsual ? kUsual : widest + kGap) / room * all));
  return std::clamp(std::max(apart, (all + 11) / 12), 1, std::max(1, all));
}

void draw_scales(Canvas& canvas, const TradeoffPanel& panel, const PlotArea& at) {
  const PixelBox& p = at.plot;
  TextStyle style = small_text();
  style.across = Anchor::end;
  const Ticks rates = ticks_up(0.0, at.fastest, p.y_max - p.y_min);
  for (const double rate : rates.at) {
    const double y = std::floor(at.y(rate)) + 0.5;
    canvas.line({p.x_min + 0.0, y}, {p.x_max + 0.0, y}, theme::kHairline, theme::kGridLine);
    canvas.text({p.x_min - 11.0, y}, rate_text(rate), style);
  }
  style.across = Anchor::middle;
  style.down = Anchor::start;
  const int step = decades_apart(at);
  for (int decade = at.error.from; decade <= at.error.to; decade += step) {
    const double x = std::floor(at.x(std::pow(10.0, decade))) + 0.5;
    canvas.line({x, p.y_min + 0.0}, {x, p.y_max + 0.0}, theme::kHairline, theme::kGridLine);
    draw_label_across(canvas, {x, p.y_max + 11.0}, power_of_ten(decade));
  }
  canvas.text({at.x(0.0), p.y_max + 11.0}, "none", style);
  canvas.line({p.x_min + at.nothing(), p.y_min + 0.0}, {p.x_min + at.nothing(), p.y_max + 0.0}, theme::kHairline,
              theme::kZeroLine);
  double y = p.y_max + 42.0;
  for (const std::string& line : wrapped_text(panel.error_name, style, p.x_max - p.x_min)) {
    canvas.text({0.5 * (p.x_min + p.x_max), y}, line, style);
    y += kErrorNameLine;
  }
  style.upwards = true;
  style.down = Anchor::middle;
  canvas.text({at.edge + 20.0, 0.5 * (p.y_min + p.y_max)}, panel.rate_name, style);
}

/// Draws the line through the Pareto-optimal modes.
void draw_front(Canvas& canvas, const TradeoffPanel& panel, const PlotArea& at) {
  std::vector<TradeoffPoint> front;
  for (const TradeoffPoint& point : panel.points)
    if (point.front) front.push_back(point);
  std::sort(front.begin(), front.end(), [](const auto& a, const auto& b) { return a.rate < b.rate; });
  std::vector<glm::dvec2> line;
  for (const TradeoffPoint& point : front) line.push_back({at.x(point.middle), at.y(point.rate)});
  if (line.size() > 1) canvas.polyline(line, theme::kCurve, with_opacity(theme::kBlue, 0.4));
}

/// "skip4, 25 % covered".
std::string label_of(const TradeoffPoint& point) {
  const double percent = std::floor(100.0 * point.covered.part);  // never 100 if an element is not covered
  return fmt::format("{}, {:.0f} % covered", point.name, percent);
}

void draw_points(Canvas& canvas, const TradeoffPanel& panel, const PlotArea& at) {
  Labels labels(at.plot);
  const auto keep_free = [&](double x, double y) { labels.forbid({{x - 8.0, y - 8.0}, {x + 8.0, y + 8.0}}); };
  for (const TradeoffPoint& point : panel.points) {
    const std::uint32_t color = point.front ? theme::kBlue : theme::kDominated;
    const glm::dvec2 mark{at.x(point.middle), at.y(point.rate)};
    const Line whisker{{at.x(point.low), mark.y}, {at.x(point.high), mark.y}};
    canvas.line(whisker.a, whisker.b, theme::kOutline, with_opacity(color, 0.6));
    labels.forbid({{whisker.a.x - 3.0, mark.y - 6.0}, {whisker.b.x + 3.0, mark.y + 6.0}});
    for (const glm::dvec2& end : {whisker.a, whisker.b})
      canvas.line({end.x, end.y - 5.0}, {end.x, end.y + 5.0}, theme::kOutline, color);
    if (point.covered.part > 0.0) {
      draw_cross(canvas, {at.x(point.covered.high), mark.y}, 5.0, theme::kOutline, theme::kVermillion);
      canvas.ring({at.x(point.covered.bound), mark.y}, 7.0, theme::kOutline, theme::kVermillion);
      keep_free(at.x(point.covered.high), mark.y);
      keep_free(at.x(point.covered.bound), mark.y);
    }
    canvas.disc(mark, 6.0, color);
    if (!point.front) canvas.disc(mark, 3.5, theme::kWhite);
    keep_free(mark.x, mark.y);
  }
  for (const TradeoffPoint& point : panel.points) {
    TextStyle style = small_text();
    style.bold = point.front;
    style.color = point.front ? theme::kInk : theme::kMinorLabel;
    style.halo = theme::kWhite;
    const glm::dvec2 mark[] = {{at.x(point.middle), at.y(point.rate)}};
    labels.place(canvas, mark, label_of(point), style, {.nearest = 10.0, .farthest = 120.0});
  }
}

void draw_panel(Canvas& canvas, const TradeoffPanel& panel, const PlotArea& at) {
  draw_scales(canvas, panel, at);
  const PixelBox& p = at.plot;
  canvas.clip(p);
  draw_front(canvas, panel, at);
  draw_points(canvas, panel, at);
  canvas.unclip();
  draw_frame(canvas, p);
  TextStyle style = small_text();
  style.bold = true;
  canvas.text({p.x_min - 0.5, p.y_min - 20.5}, panel.title, style);
}

}  // namespace

void draw_tradeoff(const std::string& title, const std::string& subtitle, std::span<const TradeoffPanel> panels,
                   const std::string& path, const Page& page) {
  const int width = page_pixels(page, page.width, kTradeoffWidth);
  const int left = kTradeoffLeft + static_cast<int>(page_edge(page));
  const int right = width - kTradeoffRight - static_cast<int>(page_edge(page));
  const double heading_left = legend_left(page, left);
  const Heading heading = make_heading(title, subtitle, right - heading_left, page);
  const auto between = [&](const TradeoffPanel& panel) {
    const std::size_t lines = wrapped_text(panel.error_name, small_text(), right - left).size();
    return kBetween + static_cast<int>(kErrorNameLine * (static_cast<double>(lines) - 1.0));
  };
  int all_between = 0;
  for (const TradeoffPanel& panel : panels) all_between += between(panel);
  int plot = page.width > 0.0 ? std::clamp(right - left, kLowestPanel, kPlot) : kPlot;
  if (page.height > 0.0 && !panels.empty())
    plot = std::max(kLowestPanel, (page_pixels(page, page.height, 0) - static_cast<int>(heading.height) - all_between) /
                                      static_cast<int>(panels.size()));
  const int height = static_cast<int>(heading.height) + static_cast<int>(panels.size()) * plot + all_between;
  Canvas canvas(width, std::max(height, 1), theme::kWhite);
  draw_heading(canvas, heading_left, heading);
  int top = static_cast<int>(heading.height) + 50;
  for (const TradeoffPanel& panel : panels) {
    PlotArea at{{left, top, right, top + plot}, {}, page_edge(page)};
    at.error = decades_of(panel.points);
    double fastest = 0.0;
    for (const TradeoffPoint& point : panel.points) fastest = std::max(fastest, point.rate);
    if (fastest > 0.0) at.fastest = 1.3 * fastest;
    draw_panel(canvas, panel, at);
    top += plot + between(panel);
  }
  save_picture(canvas.drawing(), path, page);
}

}  // namespace sf::viz
