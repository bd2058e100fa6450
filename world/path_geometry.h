#pragma once
// Where one is along a path.

#include "world/world.h"

namespace sf::world {

/// The point of a path nearest to some place.
struct PathProjection {
  std::uint32_t piece = 0;
  double s = 0.0;       ///< [m] along the whole path, in [0, its length]
  double offset = 0.0;  ///< [m] of the place from that point, positive on the left
  Pose X_WP;            ///< there, x along the path
};

double length_of(const Path& path);  ///< [m]

/// The middle `s` metres into the piece, on its own line before its start and beyond its end.
Pose pose_at(const PathPiece& piece, double s);

/// The middle `s` metres along the path; before its start and after its end the first and last piece's own line.
Pose pose_at(const Path& path, double s);

/// @param p [m] world frame
PathProjection project_onto(const Path& path, glm::dvec2 p);

}  // namespace sf::world
