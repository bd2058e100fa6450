#pragma once
// Positions along a path.

#include "world/world.h"

namespace sf::world {

/// The point of a path nearest to a given position.
struct PathProjection {
  std::uint32_t piece = 0;
  double s = 0.0;       ///< [m] along the whole path, in [0, length of the path]
  double offset = 0.0;  ///< [m] from that point to the position, positive to the left
  Pose X_WP;            ///< pose of the point, x along the path
};

double length_of(const Path& path);  ///< [m]

/// Returns the pose of the centre line `s` metres into the piece. Outside the piece, its line (straight or arc) is
/// extended.
Pose pose_at(const PathPiece& piece, double s);

/// Returns the pose of the centre line `s` metres along the path. Outside the path, the line of its first or last piece
/// is extended.
Pose pose_at(const Path& path, double s);

/// Returns the nearest point of the path. @param p [m] world frame
PathProjection project_onto(const Path& path, glm::dvec2 p);

}  // namespace sf::world
