#pragma once
// Candidate walls of a cell, from which the host's and the device's lists are built. The set is conservative: it may
// contain walls that no beam meets, but never misses one.
//
// A point p, seen from anywhere in a disc of radius q around the cell's centre, lies within asin(q / |p|) of its
// bearing from the centre. Along a segment outside the disc both tangent bearings are monotonic, so its ends bound
// them.

#include <cstdint>
#include <vector>

#include "raycast/wall_index.h"

namespace sf::raycast {

/// Geometry that all cells of one list config share.
struct CellShape {
  double size = 0.25;  ///< [m] side length of the square cell
  double range = 8.0;  ///< [m] range of the sensors

  /// [m] radius of the disc that contains the cell
  double radius() const { return size * 0.70710678118654757 * (1.0 + 1e-6) + 1e-9; }
  /// [m] largest distance from the centre to a point that a viewer in the cell can see
  double reach() const { return range * (1.0 + 1e-6) + 2.0 * radius() + 1e-6; }
};

/// A segment that is visible from its right. Coordinates are relative to the cell's centre.
struct CandidateWall {
  glm::dvec2 a, b;
  std::uint32_t row;     ///< row of the 64-bit segment
  double nearest;        ///< [m] smallest distance to any viewer in the cell
  double bearing, half;  ///< [rad] viewers see it within `half` of `bearing`; half > pi: in all directions
  int distance_ring;     ///< number of doublings from the cell's radius to its nearest point; -1: it touches the cell
};

/// Walls around one cell. Reuses its memory.
struct CandidateWalls {
  std::vector<CandidateWall> front_facing;
  std::vector<CandidateWall> back_facing;  ///< facing away from the whole cell; needed only for ties at corners
  std::vector<std::uint32_t> near;         ///< indices into the segments of the wall index
};

/// Returns the segment ab as seen by viewers in the disc of `radius` [m] around the origin.
CandidateWall candidate_wall(glm::dvec2 a, glm::dvec2 b, std::uint32_t row, double radius);

/// Returns the bearing [rad] of p with an error below 2e-6. `CandidateWall::half` includes the errors of its own and of
/// a beam's bearing.
double fast_bearing(glm::dvec2 p);

/// Clips ab to within `reach` [m] of the origin. @return false if nothing is left
bool clip(glm::dvec2& a, glm::dvec2& b, double reach);

/// Finds the walls around the cell at `centre`. @param both_sides viewers may be inside solids
void find_candidate_walls(const WallIndex& wall_index, const CellShape& shape, glm::dvec2 centre, double z,
                          bool both_sides, CandidateWalls& walls);

}  // namespace sf::raycast
