#pragma once
// Allan deviation of a series (IEEE Std 952-1997, annex C; NIST Special Publication 1065).

#include <cstddef>
#include <span>
#include <vector>

namespace sf::sensors {

/// Deviation of means over one time.
struct AllanPoint {
  double time = 0.0;       ///< [s] of the means
  double deviation = 0.0;  ///< root of half the mean square of the difference of two successive means
};

/// Returns the overlapping Allan deviation for times from `interval` to a quarter of the series, about ten per decade.
/// @param samples means over successive intervals, finite  @param interval [s] > 0
/// @return empty for fewer than four samples
std::vector<AllanPoint> allan_deviation(std::span<const double> samples, double interval);

}  // namespace sf::sensors
