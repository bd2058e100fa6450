#pragma once
// The walls of a file of outlines.

#include <vector>

#include "world/outlines.h"
#include "world/stage/polygon.h"
#include "world/well_known_geometry.h"

namespace sf::world {

/// Builds walls in the world frame, row by row.
class OutlineWalls {
 public:
  /// Both arguments must outlive it. @param take receives the walls
  OutlineWalls(const OutlineFile& file, const TakeOutline& take) : file_(file), take_(take) {}

  /// Builds the walls of one row.
  /// @param height [m] of the walls
  /// @return whether there are any walls
  /// @throws base::InputError with only the reason for a row that cannot be built
  bool build(const WellKnownGeometry& geometry, double height);
  /// Passes on the walls of the last row. @throws base::InputError if the file has too many
  void finish();

  double count() const { return count_; }               ///< number of walls passed on
  int holes_outside() const { return holes_outside_; }  ///< inner rings of the row that are not inside their outer ring

 private:
  Polygon polygon_of(std::span<const glm::dvec2> points);
  void add_outer_ring(std::span<const glm::dvec2> points);
  void add_hole(std::span<const glm::dvec2> points);
  bool is_outside(const Polygon& hole);
  glm::dvec2 placed(glm::dvec2 p) const;
  void add_wall(glm::dvec2 a, glm::dvec2 b, bool solid);

  const OutlineFile& file_;
  const TakeOutline& take_;
  std::vector<Segment> walls_;     ///< of the current row
  std::vector<std::size_t> ends_;  ///< ends of its rings and lines in `walls_`
  struct {
    std::size_t begin = 0, end = 0;
    bool solid = false;
  } outer_;  ///< the last outer ring, in `walls_`
  int holes_outside_ = 0;
  double count_ = 0.0;  ///< over all rows
  double pairs_ = 1e9;  ///< pairs of edges that may still be compared in the file
};

}  // namespace sf::world
