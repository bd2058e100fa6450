#include "viz/ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sf::viz {

double round_down(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  const double digit = value / power * (1.0 + 1e-9);
  return power * (digit >= 5.0 ? 5.0 : digit >= 2.0 ? 2.0 : 1.0);
}

Ticks make_ticks(double from, double to, double smallest_step) {
  Ticks ticks;
  ticks.step = round_down(smallest_step);
  while (ticks.step < smallest_step * (1.0 - 1e-9)) ticks.step = round_down(ticks.step * 2.5);
  ticks.decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(ticks.step) - 1e-9)));
  const double slack = 1e-9 * (to - from);
  for (double k = std::ceil((from - slack) / ticks.step); k * ticks.step <= to + slack; ++k)
    ticks.at.push_back(k * ticks.step);
  return ticks;
}

std::string tick_text(double value, int decimals) {
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  return text.find_first_not_of("-0.") == std::string::npos && text.front() == '-' ? text.substr(1) : text;
}

}  // namespace sf::viz
