#pragma once
// Positions along a path.

#include "world/world.h"

namespace sf::world {

/// The point of a path nearest to a given position.
struct PathProjection {
  std::uint32_t piece = 0;
  double s = 0.0;       ///< [m] along the whole path, in [0, length of the path]
  double offset = 0.0;  ///< [m] from that point to the position, positive on the left
  Pose X_WP;            ///< pose of the point, x along the path
};

double length_of(const Path& path);  ///< [m]

/// Pose of the centre line `s` metres into the piece. Before its start and beyond its end the piece's own line
/// (straight or arc) continues.
Pose pose_at(const PathPiece& piece, double s);

/// Pose of the centre line `s` metres along the path. Before the start and after the end, the line of the first and of
/// the last piece continues.
Pose pose_at(const Path& path, double s);

/// @param p [m] world frame
PathProjection project_onto(const Path& path, glm::dvec2 p);

}  // namespace sf::world
