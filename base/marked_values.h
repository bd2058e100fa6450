#pragma once
// Values of a reading for consumers that ignore its flags.

#include <span>
#include <vector>

#include "base/echo.h"

namespace sf::base {

/// Returns the values of `reading` after `mark_too_near`. @param own storage for the values if the reading has flags
inline std::span<const double> marked_values(const ReadingBlock& reading, std::vector<double>& own) {
  if (reading.quality.empty()) return reading.values;
  own.assign(reading.values.begin(), reading.values.end());
  mark_too_near(reading.quality, own);
  return own;
}

}  // namespace sf::base
