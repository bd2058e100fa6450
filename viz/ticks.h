#pragma once
// Round numbers along an axis.

#include <string>
#include <vector>

namespace sf::viz {

struct Ticks {
  double step = 1.0;  ///< 1, 2 or 5 times a power of ten, in the axis' unit
  int decimals = 0;   ///< digits after the point, enough to distinguish the ticks
  std::vector<double> at;
};

/// The largest 1, 2 or 5 times a power of ten that is at most `value` > 0.
double round_down(double value);

/// Multiples of a round step, at least `smallest_step` > 0, within [from, to].
Ticks make_ticks(double from, double to, double smallest_step);

std::string tick_text(double value, int decimals);

}  // namespace sf::viz
