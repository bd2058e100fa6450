#pragma once
// Elements of range readings at the limits of their sensor. docs/sensors.md has the table of all outputs.

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "base/reading.h"

namespace sf::base {

/// A range sensor measures ranges in [min, max). Rule: 0 <= min <= max.
struct RangeLimits {
  double min = 0.0;       ///< [m]
  double max = HUGE_VAL;  ///< [m]
};

/// The state of one element of a range reading.
enum class Echo : std::uint8_t {
  too_near,  ///< a surface nearer than `min`
  valid,     ///< a surface in [min, max)
  none       ///< no surface before `max`
};

/// Classifies an element.
/// @param range [m] of a reading after `mark_too_near`; NaN: none
inline Echo echo_of(double range, const RangeLimits& limits) {
  if (range < limits.min) return Echo::too_near;
  return range < limits.max ? Echo::valid : Echo::none;
}

/// Replaces the ranges of surfaces that are too near, `min` with a quality flag in readings, by -infinity, for outputs
/// without flags: recordings and tables.
/// @param flags one per element; empty: none  @param values of the same reading; the range is an element's first
inline void mark_too_near(std::span<const QualityFlag> flags, std::span<double> values) {
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i] == QualityFlag::too_near) values[values.size() / flags.size() * i] = -HUGE_VAL;
}

/// [m] The largest float32 that is not above `limit`, and the smallest that is not below it.
inline float float_below(double limit) {
  const auto nearest = static_cast<float>(limit);
  return nearest > limit ? std::nextafter(nearest, -HUGE_VALF) : nearest;
}
inline float float_above(double limit) {
  const auto nearest = static_cast<float>(limit);
  return nearest < limit ? std::nextafter(nearest, HUGE_VALF) : nearest;
}

/// [m] `range` as float32 after REP 117: -infinity for a surface that is too near, infinity for none, NaN for NaN.
/// Valid ranges are rounded to nearest, but not out of [min, max), so that they pass any test against the limits.
inline float rep117_range(double range, const RangeLimits& limits) {
  if (std::isnan(range)) return std::numeric_limits<float>::quiet_NaN();
  const Echo echo = echo_of(range, limits);
  if (echo == Echo::too_near) return -HUGE_VALF;
  if (echo == Echo::none) return HUGE_VALF;
  const auto nearest = static_cast<float>(range);
  if (nearest < limits.min) return float_above(limits.min);
  return nearest < limits.max ? nearest : std::nextafter(nearest, -HUGE_VALF);
}

}  // namespace sf::base
