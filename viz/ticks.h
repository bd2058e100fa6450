#pragma once
// Round numbers along an axis, and numbers as texts of a figure: with true minus signs (U+2212), which are as wide as a
// plus sign and do not break lines.

#include <string>
#include <vector>

namespace sf::viz {

struct Ticks {
  double step = 1.0;  ///< 1, 2 or 5 times a power of ten, in the axis' unit
  int decimals = 0;   ///< digits after the point, enough to distinguish the ticks
  std::vector<double> at;
  // Stated with the axis' name (viz/scales.h): labels are (value - offset) / 10^exponent.
  int exponent = 0;     ///< a multiple of 3
  double offset = 0.0;  ///< 0 but where labels of the values themselves would be too wide
};

/// The largest 1, 2 or 5 times a power of ten that is at most `value` > 0.
double round_down(double value);

/// Multiples of a round step, at least `smallest_step` > 0, within [from, to].
Ticks make_ticks(double from, double to, double smallest_step);

std::string tick_text(double value, int decimals);
/// The label of one of the ticks.
std::string tick_text(double value, const Ticks& ticks);

/// `text` with U+2212 for each hyphen: for texts of numbers alone.
std::string with_minus(const std::string& text);

/// "10⁻⁶"; "1" for 0.
std::string power_of_ten(int exponent);

/// A number in a sentence, with `digits` significant digits: "0.5", "\u22122×10⁻⁶", "10⁻⁶".
std::string number_text(double value, int digits = 6);

}  // namespace sf::viz
