#pragma once
// Ranges from packets at the limits of their sensor, which need not be whole units of the wire.

#include <algorithm>
#include <cmath>
#include <span>

#include "base/echo.h"

namespace sf::sensors {

/// The limits of a range sensor, and the values of their words on the wire. A word at or beyond that of a limit is read
/// as the limit. Rounding therefore neither turns an empty beam into a surface, nor a surface that is too near into a
/// valid range.
struct WireLimits {
  base::RangeLimits exact;
  base::RangeLimits rounded;

  /// Returns the range of a word [m]. @param metres the word's number; infinity and NaN are kept
  double range(double metres) const {
    if (exact.min > 0.0 && metres <= rounded.min) return exact.min;
    return metres >= rounded.max && std::isfinite(metres) ? exact.max : metres;
  }

  /// Returns the largest difference [m] between the ranges of a sensor and the limits that a receiver reads for them.
  /// It is less than `step`, the step of the wire. @param ranges in `exact`, or infinite
  double error(std::span<const double> ranges, double step) const {
    const double half = 0.500001 * step;  // with a margin for rounding numbers to words
    const double low = exact.min > 0.0 ? rounded.min + half : 0.0, high = rounded.max - half;
    double largest = 0.0;
    for (const double range : ranges) {
      if (range <= low) largest = std::max(largest, range - exact.min);
      if (range >= high) largest = std::max(largest, exact.max - range);
    }
    return largest;
  }
};

}  // namespace sf::sensors
