#include "viz/tradeoff_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "viz/canvas.h"
#include "viz/color.h"
#include "viz/heading.h"
#include "viz/labels.h"
#include "viz/legend.h"
#include "viz/theme.h"
#include "viz/ticks.h"

namespace sf::viz {
namespace {

// [px]
constexpr int kTradeoffWidth = 1400;
constexpr int kTradeoffLeft = 150;
constexpr int kTradeoffRight = 40;
constexpr int kPlot = 400;
constexpr int kLowestPanel = 200;
constexpr int kBetween = 150;       ///< title of a panel, and labels below its plot
constexpr double kNothing = 120.0;  ///< column of errors that are 0

/// Errors below this are rounding errors and count as 0.
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
  double fastest = 1.0;  ///< [1/s] upper end; the lower one is 0

  double x(double error_value) const {
    if (!(error_value >= kLeast)) return plot.x_min + 0.5 * kNothing;
    if (std::isinf(error_value)) return plot.x_max;
    const double part = (std::log10(error_value) - error.from) / (error.to - error.from);
    return plot.x_min + kNothing + part * (plot.x_max - plot.x_min - kNothing);
  }
  double y(double value) const { return plot.y_max - value / fastest * (plot.y_max - plot.y_min); }
};

std::string power(int exponent) { return exponent == 0 ? "1" : fmt::format("1e{}", exponent); }

/// "40 M", "5 k", "0".
std::string rate_text(double rate) {
  if (rate >= 1e6) return fmt::format("{:g} M", rate * 1e-6);
  if (rate >= 1e3) return fmt::format("{:g} k", rate * 1e-3);
  return fmt::format("{:g}", std::abs(rate));  // no -0
}

void draw_scales(Canvas& canvas, const TradeoffPanel& panel, const PlotArea& at) {
  const PixelBox& p = at.plot;
  TextStyle style = small_text();
  style.across = Anchor::end;
  const Ticks rates = make_ticks(0.0, at.fastest, at.fastest * 60.0 / (p.y_max - p.y_min));
  for (const double rate : rates.at) {
    const double y = std::floor(at.y(rate)) + 0.5;
    canvas.line({p.x_min + 0.0, y}, {p.x_max + 0.0, y}, theme::kHairline, theme::kGridLine);
    canvas.text({p.x_min - 11.0, y}, rate_text(rate), style);
  }
  style.across = Anchor::middle;
  style.down = Anchor::start;
  const int most = std::clamp((p.x_max - p.x_min) / 100, 3, 12);  // labels
  const int step = std::max(1, (at.error.to - at.error.from + most - 1) / most);
  for (int decade = at.error.from; decade <= at.error.to; decade += step) {
    const double x = std::floor(at.x(std::pow(10.0, decade))) + 0.5;
    canvas.line({x, p.y_min + 0.0}, {x, p.y_max + 0.0}, theme::kHairline, theme::kGridLine);
    canvas.text({x, p.y_max + 11.0}, power(decade), style);
  }
  canvas.text({at.x(0.0), p.y_max + 11.0}, "none", style);
  canvas.line({p.x_min + kNothing, p.y_min + 0.0}, {p.x_min + kNothing, p.y_max + 0.0}, theme::kHairline,
              theme::kZeroLine);
  canvas.text({0.5 * (p.x_min + p.x_max), p.y_max + 42.0}, panel.error_name, style);
  style.upwards = true;
  style.down = Anchor::middle;
  canvas.text({46.0, 0.5 * (p.y_min + p.y_max)}, panel.rate_name, style);
}

/// The line through the Pareto-optimal modes.
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
  const double percent = std::floor(100.0 * point.covered.part);  // never 100 when an element is not covered
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
  const double x0 = p.x_min - 0.5, y0 = p.y_min - 0.5, x1 = p.x_max + 0.5, y1 = p.y_max + 0.5;
  const glm::dvec2 corners[] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}};
  canvas.polyline(corners, theme::kHairline, theme::kFrame);
  TextStyle style = small_text();
  style.bold = true;
  canvas.text({x0, y0 - 20.0}, panel.title, style);
}

}  // namespace

void draw_tradeoff(const std::string& title, const std::string& subtitle, std::span<const TradeoffPanel> panels,
                   const std::string& path, const Page& page) {
  const int width = page_pixels(page.width, kTradeoffWidth);
  const Heading heading = make_heading(title, subtitle, width - kTradeoffLeft - kTradeoffRight, page);
  int plot = kPlot;
  if (page.height > 0.0 && !panels.empty())
    plot = std::max(
        kLowestPanel,
        (page_pixels(page.height, 0) - static_cast<int>(heading.height)) / static_cast<int>(panels.size()) - kBetween);
  const int height = static_cast<int>(heading.height) + static_cast<int>(panels.size()) * (plot + kBetween);
  Canvas canvas(width, std::max(height, 1), theme::kWhite);
  draw_heading(canvas, kTradeoffLeft, heading);
  int top = static_cast<int>(heading.height) + 50;
  for (const TradeoffPanel& panel : panels) {
    PlotArea at{{kTradeoffLeft, top, width - kTradeoffRight, top + plot}, {}};
    at.error = decades_of(panel.points);
    double fastest = 0.0;
    for (const TradeoffPoint& point : panel.points) fastest = std::max(fastest, point.rate);
    if (fastest > 0.0) at.fastest = 1.3 * fastest;
    draw_panel(canvas, panel, at);
    top += plot + kBetween;
  }
  save_picture(canvas.drawing(), path, page);
}

}  // namespace sf::viz
