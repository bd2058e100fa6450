#pragma once
// Classifies elements of range readings at the limits of the sensor. docs/sensors.md lists all outputs.

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "base/reading.h"

namespace sf::base {

/// Range limits of a sensor, which measures ranges in [min, max). Invariant: 0 <= min <= max.
struct RangeLimits {
  double min = 0.0;       ///< [m]
  double max = HUGE_VAL;  ///< [m]
};

/// State of one element of a range reading.
enum class Echo : std::uint8_t {
  too_near,  ///< a surface is nearer than `min`
  valid,     ///< a surface is in [min, max)
  none       ///< there is no surface before `max`
};

/// Classifies an element.
/// @param range [m] from a reading after `mark_too_near`; NaN counts as `none`
inline Echo echo_of(double range, const RangeLimits& limits) {
  if (range < limits.min) return Echo::too_near;
  return range < limits.max ? Echo::valid : Echo::none;
}

/// Replaces the ranges of surfaces that are too near with -infinity, for outputs without flags: recordings and tables.
/// Readings hold `min` and a quality flag for such elements.
/// @param flags one per element, or empty  @param values of the same reading; the range is the first value of an
/// element
inline void mark_too_near(std::span<const QualityFlag> flags, std::span<double> values) {
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i] == QualityFlag::too_near) values[values.size() / flags.size() * i] = -HUGE_VAL;
}

/// Rounds `limit` [m] to float32: down in `float_below`, up in `float_above`.
inline float float_below(double limit) {
  const auto nearest = static_cast<float>(limit);
  return nearest > limit ? std::nextafter(nearest, -HUGE_VALF) : nearest;
}
inline float float_above(double limit) {
  const auto nearest = static_cast<float>(limit);
  return nearest < limit ? std::nextafter(nearest, HUGE_VALF) : nearest;
}

/// Returns `range` [m] as float32 according to REP 117: -infinity for a surface that is too near, infinity for no
/// surface, NaN for NaN. Rounds valid ranges to nearest but keeps them in [min, max), so comparisons with the limits
/// still hold.
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
