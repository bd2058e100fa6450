#pragma once
// Bearings of the samples of a planar scan.

#include <cstdint>

namespace sf::base {

/// Returns the bearing of sample `i` of a scan in the sensor's frame [rad]. Exact at both ends of the field of view and
/// exactly symmetric about 0.
inline double bearing_of(double fov, std::uint32_t samples, std::uint32_t i) {
  if (samples < 2) return 0.0;
  const double last = samples - 1;
  const double step = fov / last;
  return 2.0 * i <= last ? -0.5 * fov + i * step : 0.5 * fov - (last - i) * step;
}

}  // namespace sf::base
