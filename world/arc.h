#pragma once
// Arcs as chords.

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/pose.h"

namespace sf::world {

inline constexpr double kArcError = 1e-6;  ///< [m] largest distance between an arc and its chords

/// Number of chords, at least 1, that stay within `error` of an arc. @param angle [rad] of the arc, not negative
/// @param radius in the unit of `error`, above zero
inline double chord_count(double radius, double angle, double error) {
  // A chord of angle phi is r (1 - cos(phi / 2)) off. The root keeps digits where the quotient is small.
  return std::max(1.0, std::ceil(angle / (4.0 * std::asin(std::sqrt(std::min(0.5, 0.5 * error / radius))))));
}

/// Appends the chords of the arc from `line.back()` through `middle` to `end`, both of which become corners. It is a
/// whole circle, counter-clockwise, where it ends at its start, and straight where the three are in line.
/// @param most chords. @return false, without a change, where more are needed
bool append_arc(std::vector<glm::dvec2>& line, glm::dvec2 middle, glm::dvec2 end, double error, double most);

}  // namespace sf::world
