#include "world/path_geometry.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::world {

namespace {

/// Returns the distance [m] along the piece of the point of its line nearest to `p`, not clamped to the piece.
double project(const PathPiece& piece, glm::dvec2 p) {
  const glm::dvec2 q = base::rotate(-piece.X_WP.yaw, p - glm::dvec2{piece.X_WP.x, piece.X_WP.y});
  if (piece.curvature == 0.0) return q.x;
  const double radius = 1.0 / piece.curvature;
  const double side = piece.curvature > 0.0 ? 1.0 : -1.0;
  const double angle = base::atan2(q.x, side * (radius - q.y));
  // A position behind the start of an arc is before the arc, not almost a full turn ahead. The limit is half of the
  // remaining turn.
  const double turn = piece.length * std::abs(piece.curvature);
  const double ahead = angle < 0.0 && angle + 2.0 * M_PI < M_PI + 0.5 * turn ? angle + 2.0 * M_PI : angle;
  return ahead * std::abs(radius);
}

}  // namespace

Pose pose_at(const PathPiece& piece, double s) {
  if (piece.curvature == 0.0) return base::compose(piece.X_WP, {s, 0.0, 0.0, 0.0});
  const double angle = s * piece.curvature;
  const double half = base::sin(0.5 * angle);
  return base::compose(piece.X_WP,
                       {base::sin(angle) / piece.curvature, 2.0 * half * half / piece.curvature, 0.0, angle});
}

double length_of(const Path& path) {
  double length = 0.0;
  for (const PathPiece& piece : path.pieces) length += piece.length;
  return length;
}

Pose pose_at(const Path& path, double s) {
  std::size_t i = 0;
  for (; i + 1 < path.pieces.size() && s > path.pieces[i].length; ++i) s -= path.pieces[i].length;
  return pose_at(path.pieces[i], s);
}

PathProjection project_onto(const Path& path, glm::dvec2 p) {
  PathProjection best;
  double least = HUGE_VAL;
  double start = 0.0;
  for (std::uint32_t i = 0; i < path.pieces.size(); ++i) {
    const PathPiece& piece = path.pieces[i];
    const double s = std::clamp(project(piece, p), 0.0, piece.length);
    const Pose X_WP = pose_at(piece, s);
    const glm::dvec2 d = p - glm::dvec2{X_WP.x, X_WP.y};
    const double far = glm::length(d);
    if (far < least) {
      least = far;
      const double left = base::cross(base::rotate(X_WP.yaw, {1.0, 0.0}), d);
      best = {i, start + s, std::copysign(far, left), X_WP};
    }
    start += piece.length;
  }
  return best;
}

}  // namespace sf::world
