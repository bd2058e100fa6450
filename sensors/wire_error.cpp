#include "sensors/wire_error.h"

#include <algorithm>
#include <cmath>

namespace sf::sensors {

/// The conversion of a value to a word and back rounds three times, each by at most 2^-53 of the value.
double wire_error(std::span<const double> values, std::size_t width, double step, double least, double most) {
  double largest = 0.0;
  for (std::size_t i = 0; i < values.size(); i += width) {
    if (!std::isfinite(values[i])) continue;
    if (values[i] < least - 0.5 * step || values[i] > most + 0.5 * step) return HUGE_VAL;
    largest = std::max(largest, std::abs(values[i]));
  }
  return 0.5 * step + 0x1p-51 * largest;
}

}  // namespace sf::sensors
