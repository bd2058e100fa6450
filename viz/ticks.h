#pragma once
// Round numbers along an axis, and number formatting for figures: with true minus signs (U+2212), which are as wide as
// a plus sign and do not break lines.

#include <string>
#include <vector>

namespace sf::viz {

struct Ticks {
  double step = 1.0;  ///< 1, 2 or 5 times a power of ten, in the unit of the axis
  int decimals = 0;   ///< digits after the point, enough to distinguish the ticks
  std::vector<double> at;
  // Shown with the axis name (viz/scales.h): labels are (value - offset) / 10^exponent.
  int exponent = 0;     ///< a multiple of 3
  double offset = 0.0;  ///< nonzero only if labels of the values themselves would be too wide
  bool powers = false;  ///< of a logarithmic axis: ticks are the exponents of powers of ten, which are their labels
};

/// Returns the largest 1, 2 or 5 times a power of ten that is at most `value` > 0.
double round_down(double value);

/// Returns multiples of a round step, at least `smallest_step` > 0, within [from, to].
Ticks make_ticks(double from, double to, double smallest_step);

std::string tick_text(double value, int decimals);
/// Returns the label of a tick.
std::string tick_text(double value, const Ticks& ticks);

/// Replaces each hyphen in `text` by U+2212; for texts that consist of numbers.
std::string with_minus(const std::string& text);

/// "10⁻⁶"; "1" for 0.
std::string power_of_ten(int exponent);

/// Formats a number in a sentence with `digits` significant digits: "0.5", "\u22122×10⁻⁶", "10⁻⁶".
std::string number_text(double value, int digits = 6);

}  // namespace sf::viz
