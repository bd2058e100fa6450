#pragma once
// Walls that may be met from a cell: what both casters' lists are made of. They may hold too much, never too little.
//
// A point p seen from anywhere in a disc of radius q around the cell's centre lies within asin(q / |p|) of its bearing
// from the centre. Along a segment outside of the disc the two tangent bearings move monotonically, so the ends bound
// them.

#include <cstdint>
#include <vector>

#include "raycast/wall_index.h"

namespace sf::raycast {

/// Geometry that all cells of one family share.
struct CellShape {
  double size = 0.25;  ///< [m] side of the square cell
  double range = 8.0;  ///< [m] of the sensors it serves

  /// [m] of the disc round the cell
  double radius() const { return size * 0.70710678118654757 * (1.0 + 1e-6) + 1e-9; }
  /// [m] farthest useful coordinate
  double reach() const { return range * (1.0 + 1e-6) + 2.0 * radius() + 1e-6; }
};

/// A segment seen from its right, relative to a cell's centre.
struct CandidateWall {
  glm::dvec2 a, b;
  std::uint32_t row;     ///< of the exact segment
  double nearest;        ///< [m] to any viewer
  double bearing, half;  ///< [rad] where viewers see it; a half beyond pi: all round
  int distance_ring;     ///< step of distance
};

/// Walls round one cell. Keeps its memory between uses.
struct CandidateWalls {
  std::vector<CandidateWall> front_facing;
  std::vector<CandidateWall> back_facing;  ///< facing away from the whole cell: they decide ties at corners
  WallIndex::Query query;
};

/// The part of ab within `reach` of the origin; false when there is none.
bool clip(glm::dvec2& a, glm::dvec2& b, double reach);

/// Finds the walls round the cell at `centre`. With `both_sides`, viewers may lie inside of solids.
void find_candidate_walls(const WallIndex& wall_index, const CellShape& shape, glm::dvec2 centre, bool both_sides,
                          CandidateWalls& walls);

}  // namespace sf::raycast
