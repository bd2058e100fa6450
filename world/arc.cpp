#include "world/arc.h"

#include "base/elementary.h"

namespace sf::world {

namespace {

/// Returns the centre of the circle through the origin, `u` and `v`, which are not collinear with it.
glm::dvec2 circle_centre(glm::dvec2 u, glm::dvec2 v) {
  const double uu = dot(u, u), vv = dot(v, v);
  return glm::dvec2(v.y * uu - u.y * vv, u.x * vv - v.x * uu) / (2.0 * base::cross(u, v));
}

/// Returns the angle [rad] from `p` to `q` in the given direction; negative for clockwise.
double arc_turn(glm::dvec2 p, glm::dvec2 q, bool left) {
  const double turn = base::atan2(base::cross(p, q), dot(p, q));
  if (left) return turn < 0.0 ? turn + 2.0 * M_PI : turn;
  return turn > 0.0 ? turn - 2.0 * M_PI : turn;
}

}  // namespace

bool append_arc(std::vector<glm::dvec2>& line, glm::dvec2 middle, glm::dvec2 end, double error, double most) {
  const glm::dvec2 start = line.back();
  const glm::dvec2 u = middle - start, v = end - start;
  const bool whole = start == end;
  const double side = base::cross(u, v);
  if (side == 0.0 && !whole) {
    line.push_back(end);
    return true;
  }
  const glm::dvec2 centre = start + (whole ? 0.5 * u : circle_centre(u, v));
  const glm::dvec2 corners[] = {start, middle, end};
  double turns[2], chords[2];
  for (int i = 0; i < 2; ++i) {
    const glm::dvec2 from = corners[i] - centre;
    turns[i] = arc_turn(from, corners[i + 1] - centre, side >= 0.0);
    chords[i] = chord_count(length(from), std::abs(turns[i]), error);
  }
  if (!(chords[0] + chords[1] <= most)) return false;
  for (int i = 0; i < 2; ++i) {
    for (double k = 1.0; k < chords[i]; ++k)
      line.push_back(centre + base::rotate(turns[i] * (k / chords[i]), corners[i] - centre));
    line.push_back(corners[i + 1]);
  }
  return true;
}

}  // namespace sf::world
