#pragma once
// Spatial index of the walls that beams at one height can meet.

#include <cstdint>
#include <vector>

#include "world/wall_grid.h"
#include "world/world.h"

namespace sf::raycast {

/// A visible segment; `row` is its row in `World::walls`.
struct IndexedWall {
  glm::dvec2 a;
  glm::dvec2 b;
  std::uint32_t row;
  bool solid_left;
};

/// Immutable after construction. Several threads may query it, each with its own `Query`.
class WallIndex {
 public:
  /// Indexes the walls visible at height `z` [m]. `world` need not outlive it. @param typical_range [m]
  WallIndex(const world::World& world, double z, double typical_range);

  const std::vector<IndexedWall>& segments() const { return segments_; }
  glm::dvec2 low() const { return low_; }  ///< [m] corner of the bounding box
  glm::dvec2 high() const { return high_; }

  /// Scratch of one thread.
  struct Query {
    std::vector<std::uint32_t> found;  ///< indices into `segments()`, each once, in unspecified order
    std::vector<std::uint32_t> stamps;
    std::uint32_t stamp = 0;
  };
  /// Finds every segment within `radius` [m] of `p`, and possibly more.
  void near(glm::dvec2 p, double radius, Query& query) const;

  /// True when `p` lies in a solid: the winding number of all outlines with a known solid side is not 0. Within
  /// rounding of a surface either result is possible.
  bool inside_solid(glm::dvec2 p) const;

 private:
  struct Span {
    int x0, y0, x1, y1;
  };
  Span cells_of(double x0, double y0, double x1, double y1) const;
  void index_cells(double typical_range);
  void index_bands();

  std::vector<IndexedWall> segments_;
  glm::dvec2 low_, high_;
  double cell_ = 1.0;
  int columns_ = 1, rows_ = 1;
  std::vector<std::uint32_t> cell_first_, cell_items_;  ///< segments by cell
  double band_ = 1.0;
  int bands_ = 1;
  std::vector<std::uint32_t> band_first_;              ///< segments by interval of y, for winding numbers:
  std::vector<std::uint32_t> from_left_, from_right_;  ///< each band by ascending least x, and by descending largest x
};

}  // namespace sf::raycast
