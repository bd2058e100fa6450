#pragma once
// Axis-aligned boxes in the plane.

#include <algorithm>
#include <cmath>
#include <glm/ext/vector_double2.hpp>

namespace sf::base {

/// Closed. [m]
struct Box {
  glm::dvec2 min;
  glm::dvec2 max;
};

/// The box of no point: `united` with it changes nothing, and it meets no other.
inline Box empty_box() { return {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}}; }

/// The square of side 2 `reach` [m].
inline Box box_around(glm::dvec2 centre, double reach) {
  return {{centre.x - reach, centre.y - reach}, {centre.x + reach, centre.y + reach}};
}

/// Box of two corners, in any order.
inline Box box_of(glm::dvec2 p, glm::dvec2 q) {
  return {{std::min(p.x, q.x), std::min(p.y, q.y)}, {std::max(p.x, q.x), std::max(p.y, q.y)}};
}

/// The smallest box that contains both.
inline Box united(const Box& a, const Box& b) {
  return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y)},
          {std::max(a.max.x, b.max.x), std::max(a.max.y, b.max.y)}};
}

/// True when the boxes share a point.
inline bool meet(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y;
}

}  // namespace sf::base
