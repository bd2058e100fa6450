#pragma once
// The values of a reading for consumers that do not look at its flags.

#include <span>
#include <vector>

#include "base/echo.h"

namespace sf::base {

/// The values of `reading` after `mark_too_near`. @param own holds them where the reading has flags
inline std::span<const double> marked_values(const ReadingBlock& reading, std::vector<double>& own) {
  if (reading.quality.empty()) return reading.values;
  own.assign(reading.values.begin(), reading.values.end());
  mark_too_near(reading.quality, own);
  return own;
}

}  // namespace sf::base
