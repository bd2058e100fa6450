#include "viz/scales.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "viz/heading.h"
#include "viz/legend.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

// [px]
constexpr double kUsualTickAcross = 110.0;
constexpr double kUsualTickUp = 60.0;
constexpr double kLowestTickUp = 20.0;
constexpr double kLabelGap = 16.0;  ///< between neighbouring labels

constexpr int kMostDecimals = 4;
constexpr double kLargeNumber = 1e5;  ///< labels from here on take an exponent

/// Labels of very large or very small numbers are in thousands, millionths and so on.
Ticks with_exponent(Ticks ticks, double from, double to) {
  const double most = std::max(std::abs(from), std::abs(to));
  if ((most < kLargeNumber && ticks.decimals <= kMostDecimals) || !(most > 0.0)) return ticks;
  ticks.exponent = 3 * static_cast<int>(std::floor(std::log10(most) / 3.0 + 1e-9));
  return ticks;
}

Ticks ticks_apart(double from, double to, double pixels, double apart, bool whole) {
  const double step = apart / std::max(pixels, 1.0) * (to - from);
  return with_exponent(make_ticks(from, to, whole ? std::max(step, 1.0) : step), from, to);
}

}  // namespace

Ticks ticks_across(double from, double to, double pixels, bool whole) {
  double apart = std::min(kUsualTickAcross, pixels / 3.0);
  Ticks ticks = ticks_apart(from, to, pixels, apart, whole);
  const auto touch = [&] { return ticks.step / (to - from) * pixels < widest_label(ticks) + kLabelGap; };
  while (ticks.at.size() > 1 && touch()) ticks = ticks_apart(from, to, pixels, apart *= 1.3, whole);
  for (double closer = apart; ticks.at.size() < 2 && closer > kLowestTickUp;) {
    const Ticks sparse = std::exchange(ticks, ticks_apart(from, to, pixels, closer *= 0.8, whole));
    if (ticks.at.size() < 2 || !touch()) continue;
    return sparse;
  }
  return ticks;
}

Ticks ticks_up(double from, double to, double pixels, bool whole) {
  double apart = std::clamp(pixels / 3.0, kLowestTickUp, kUsualTickUp);
  Ticks ticks = ticks_apart(from, to, pixels, apart, whole);
  while (ticks.at.size() < 2 && apart > kLowestTickUp) {
    apart = std::max(0.8 * apart, kLowestTickUp);
    ticks = ticks_apart(from, to, pixels, apart, whole);
  }
  return ticks;
}

double widest_label(const Ticks& ticks) {
  double widest = 0.0;
  for (const double value : ticks.at) widest = std::max(widest, text_size(tick_text(value, ticks), small_text()).x);
  return widest;
}

std::string axis_name(const std::string& name, int exponent) {
  if (exponent == 0) return name;
  const std::size_t unit = name.rfind('[');
  if (unit == std::string::npos) return name + " [" + power_of_ten(exponent) + "]";
  return name.substr(0, unit + 1) + power_of_ten(exponent) + " " + name.substr(unit + 1);
}

std::vector<std::string> name_lines(const std::string& name, double height) {
  return wrapped_text(name, small_text(), std::max(height, 90.0));
}

void draw_name_up(Canvas& canvas, double left, double middle, const std::vector<std::string>& lines) {
  TextStyle style = small_text();
  style.across = Anchor::middle;
  style.upwards = true;
  for (std::size_t i = 0; i < lines.size(); ++i)
    canvas.text({left + 12.0 + kNameLine * static_cast<double>(i), middle}, lines[i], style);
}

void draw_label_across(Canvas& canvas, glm::dvec2 at, const std::string& text) {
  constexpr double kFree = 2.0;
  TextStyle style = small_text();
  style.across = Anchor::middle;
  style.down = Anchor::start;
  const double reach = 0.5 * text_size(text, style).x + kFree;
  at.x = std::max(std::min(at.x, canvas.width() - reach), reach);
  canvas.text(at, text, style);
}

double legend_left(const Page& page, double plot_left) {
  const double edge = page_edge(page);
  return edge < page_edge({}) ? edge : plot_left;
}

void draw_frame(Canvas& canvas, const PixelBox& plot) {
  const double x0 = plot.x_min - 0.5, y0 = plot.y_min - 0.5, x1 = plot.x_max + 0.5, y1 = plot.y_max + 0.5;
  const glm::dvec2 corners[] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}};
  canvas.polyline(corners, theme::kHairline, theme::kFrame);
}

}  // namespace sf::viz
