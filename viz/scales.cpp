#include "viz/scales.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "viz/heading.h"
#include "viz/legend.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

// [px]
constexpr double kUsualTickAcross = 110.0;
constexpr double kUsualTickUp = 60.0;
constexpr double kLowestTickUp = 20.0;
constexpr double kLabelGap = 16.0;    ///< between adjacent labels
constexpr double kSmallestGap = 9.0;  ///< if there are only two

constexpr int kMostDecimals = 4;
constexpr double kLargeNumber = 1e5;  ///< larger labels use an exponent

/// @param always also if labels are short without an exponent
Ticks with_exponent(Ticks ticks, double from, double to, bool always = false) {
  ticks.exponent = label_exponent(std::max(std::abs(from), std::abs(to)), always ? kMostDecimals + 1 : ticks.decimals);
  return ticks;
}

Ticks ticks_apart(double from, double to, double pixels, double apart, bool whole) {
  const double step = apart / std::max(pixels, 1.0) * (to - from);
  return with_exponent(make_ticks(from, to, whole ? std::max(step, 1.0) : step), from, to);
}

/// [px] Returns the distance of adjacent ticks; infinite if there are fewer than two.
double spacing(const Ticks& ticks, double from, double to, double pixels) {
  return ticks.at.size() < 2 ? HUGE_VAL : (ticks.at[1] - ticks.at[0]) / (to - from) * pixels;
}

/// Returns every `every`-th tick: the multiples of that number if there are at least two, otherwise ticks around the
/// middle.
Ticks every_nth(const Ticks& all, std::size_t every) {
  const auto first_multiple = static_cast<std::size_t>(
      std::fmod(static_cast<double>(every) - std::fmod(std::round(all.at[0] / all.step), static_cast<double>(every)),
                static_cast<double>(every)));
  const std::size_t first = first_multiple + every < all.at.size() ? first_multiple : (all.at.size() - 1) % every / 2;
  Ticks ticks = all;
  ticks.at.clear();
  for (std::size_t i = first; i < all.at.size(); i += every) ticks.at.push_back(all.at[i]);
  return ticks;
}

/// For short axes on which multiples of no round step fit: returns two or more multiples of a finer step, as coarse as
/// possible. Empty if none `fit`.
template <class Fit>
Ticks sparse_ticks(double from, double to, bool whole, Fit&& fit, bool exponent = false) {
  constexpr int kSteps = 7;
  double step = round_down(to - from);
  const double least = std::max(whole ? 1.0 : 0.0, 1e-13 * std::max(std::abs(from), std::abs(to)));  // of doubles
  for (int i = 0; i < kSteps && step >= least; ++i, step = round_down(0.51 * step)) {
    const Ticks fine = with_exponent(make_ticks(from, to, step), from, to, exponent);
    for (std::size_t every = 1; every < fine.at.size(); ++every)
      if (const Ticks ticks = every_nth(fine, every); fit(ticks)) return ticks;
  }
  return {};
}

/// Labels values as differences from a round number below all of them, for values that differ only in their last
/// digits.
template <class Fit>
Ticks offset_ticks(double from, double to, bool whole, Fit&& fit) {
  const double round = std::pow(10.0, std::ceil(std::log10(to - from)));
  const double offset = round * std::floor(from / round);
  const auto moved = [&](Ticks ticks) {
    for (double& at : ticks.at) at += offset;
    ticks.offset = offset;
    return ticks;
  };
  const auto fit_moved = [&](const Ticks& ticks) { return fit(moved(ticks)); };
  Ticks ticks = sparse_ticks(from - offset, to - offset, whole, fit_moved);
  if (ticks.at.size() < 2) ticks = sparse_ticks(from - offset, to - offset, whole, fit_moved, true);
  return moved(ticks);
}

}  // namespace

Ticks ticks_across(double from, double to, double pixels, bool whole) {
  double apart = std::min(kUsualTickAcross, pixels / 3.0);
  Ticks ticks = ticks_apart(from, to, pixels, apart, whole);
  const auto fits = [&](double gap) {
    return [=](const Ticks& t) { return spacing(t, from, to, pixels) >= widest_label(t) + gap; };
  };
  while (ticks.at.size() > 1 && !fits(kLabelGap)(ticks)) ticks = ticks_apart(from, to, pixels, apart *= 1.3, whole);
  if (ticks.at.size() < 2) ticks = sparse_ticks(from, to, whole, fits(kLabelGap));
  if (ticks.at.size() < 2) ticks = sparse_ticks(from, to, whole, fits(kSmallestGap));
  if (ticks.at.size() < 2) ticks = sparse_ticks(from, to, whole, fits(kSmallestGap), true);
  if (ticks.at.size() < 2) ticks = offset_ticks(from, to, whole, fits(kSmallestGap));
  return ticks;
}

Ticks ticks_up(double from, double to, double pixels, bool whole) {
  double apart = std::clamp(pixels / 3.0, kLowestTickUp, kUsualTickUp);
  Ticks ticks = ticks_apart(from, to, pixels, apart, whole);
  while (ticks.at.size() < 2 && apart > kLowestTickUp) {
    apart = std::max(0.8 * apart, kLowestTickUp);
    ticks = ticks_apart(from, to, pixels, apart, whole);
  }
  if (ticks.at.size() > 1) return ticks;
  return sparse_ticks(from, to, whole, [&](const Ticks& t) { return spacing(t, from, to, pixels) >= kLowestTickUp; });
}

double widest_label(const Ticks& ticks) {
  double widest = 0.0;
  for (const double value : ticks.at) widest = std::max(widest, text_size(tick_text(value, ticks), small_text()).x);
  return widest;
}

/// Labels of very large or very small numbers are in thousands, millionths and so on.
int label_exponent(double most, int decimals) {
  if ((most < kLargeNumber && decimals <= kMostDecimals) || !(most > 0.0)) return 0;
  return 3 * static_cast<int>(std::floor(std::log10(most) / 3.0 + 1e-9));
}

std::string axis_name(const std::string& name, int exponent) {
  if (exponent == 0) return name;
  const std::size_t unit = name.rfind('[');
  if (unit == std::string::npos) return name + " [" + power_of_ten(exponent) + "]";
  return name.substr(0, unit + 1) + power_of_ten(exponent) + " " + name.substr(unit + 1);
}

std::string axis_name(const std::string& name, const Ticks& ticks) {
  if (ticks.offset == 0.0) return axis_name(name, ticks.exponent);
  const std::size_t unit = std::min(name.rfind(" ["), name.size());
  const std::string offset = fmt::format(" {} {:.15g}", ticks.offset > 0.0 ? "\u2212" : "+", std::abs(ticks.offset));
  return axis_name(name.substr(0, unit) + offset + name.substr(unit), ticks.exponent);
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
