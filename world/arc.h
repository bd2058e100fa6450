#pragma once
// Approximation of arcs by chords.

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/elementary.h"
#include "base/pose.h"

namespace sf::world {

inline constexpr double kArcError = 1e-6;  ///< [m] largest distance between an arc and its chords

/// Returns the number of chords, at least 1, that stay within `error` of an arc.
/// @param angle [rad] of the arc, not negative
/// @param radius in the unit of `error`, above zero
inline double chord_count(double radius, double angle, double error) {
  // A chord of angle phi deviates by r (1 - cos(phi / 2)). The square root keeps precision when the quotient is small.
  return std::max(1.0, std::ceil(angle / (4.0 * base::asin(std::sqrt(std::min(0.5, 0.5 * error / radius))))));
}

/// Appends the chords of the arc from `line.back()` through `middle` to `end`, both of which become corners. The arc is
/// a full counter-clockwise circle if it ends at its start, and straight if the three points are collinear.
/// @param most largest number of chords
/// @return false, without a change, if more are needed
bool append_arc(std::vector<glm::dvec2>& line, glm::dvec2 middle, glm::dvec2 end, double error, double most);

}  // namespace sf::world
