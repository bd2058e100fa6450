#pragma once
// Axis-aligned boxes in the plane.

#include <algorithm>
#include <cmath>
#include <glm/ext/vector_double2.hpp>

namespace sf::base {

/// Closed box [m].
struct Box {
  glm::dvec2 min;
  glm::dvec2 max;
};

/// Returns the box that contains no point. It meets no box, and `united` ignores it.
inline Box empty_box() { return {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}}; }

/// Returns the square of side 2 `reach` [m] around `centre`.
inline Box box_around(glm::dvec2 centre, double reach) {
  return {{centre.x - reach, centre.y - reach}, {centre.x + reach, centre.y + reach}};
}

/// Returns the box with two given opposite corners, in any order.
inline Box box_of(glm::dvec2 p, glm::dvec2 q) {
  return {{std::min(p.x, q.x), std::min(p.y, q.y)}, {std::max(p.x, q.x), std::max(p.y, q.y)}};
}

/// Returns the smallest box that contains both boxes.
inline Box united(const Box& a, const Box& b) {
  return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y)},
          {std::max(a.max.x, b.max.x), std::max(a.max.y, b.max.y)}};
}

/// Returns true when the boxes share a point.
inline bool meet(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y;
}

}  // namespace sf::base
