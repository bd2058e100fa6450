#include "viz/ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace sf::viz {
namespace {

/// Returns the number of digits after the point that distinguish multiples of a round step.
int decimals_of(double step) { return std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9))); }

}  // namespace

double round_down(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  const double digit = value / power * (1.0 + 1e-9);
  return power * (digit >= 5.0 ? 5.0 : digit >= 2.0 ? 2.0 : 1.0);
}

Ticks make_ticks(double from, double to, double smallest_step) {
  Ticks ticks;
  ticks.step = round_down(smallest_step);
  while (ticks.step < smallest_step * (1.0 - 1e-9)) ticks.step = round_down(ticks.step * 2.5);
  ticks.decimals = decimals_of(ticks.step);
  const double slack = 1e-9 * (to - from);
  for (double k = std::ceil((from - slack) / ticks.step); k * ticks.step <= to + slack; ++k)
    ticks.at.push_back(k * ticks.step);
  return ticks;
}

std::string with_minus(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '-' ? std::string("\u2212") : std::string(1, c);
  return out;
}

std::string tick_text(double value, int decimals) {
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  const bool zero = text.find_first_not_of("-0.") == std::string::npos && text.front() == '-';
  return with_minus(zero ? text.substr(1) : text);
}

std::string tick_text(double value, const Ticks& ticks) {
  if (ticks.powers) return power_of_ten(static_cast<int>(std::lround(value)));
  const double unit = std::pow(10.0, ticks.exponent);
  return tick_text((value - ticks.offset) / unit,
                   ticks.exponent == 0 ? ticks.decimals : decimals_of(ticks.step / unit));
}

std::string power_of_ten(int exponent) {
  constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  if (exponent == 0) return "1";
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(exponent))) text += kDigits[digit - '0'];
  return text;
}

std::string number_text(double value, int digits) {
  const std::string text = fmt::format("{:.{}g}", value, digits);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return with_minus(text);
  const std::string power = power_of_ten(std::atoi(text.c_str() + e + 1)), factor = with_minus(text.substr(0, e));
  return factor == "1" ? power : factor + "×" + power;
}

}  // namespace sf::viz
