#pragma once
// Spatial index of the walls that lasers see, for sensors at any height.

#include <cstdint>
#include <span>
#include <vector>

#include "base/box_tree.h"
#include "world/world.h"

namespace sf::raycast {

/// `row` is the segment's row in the table of all walls.
struct IndexedWall {
  glm::dvec2 a;
  glm::dvec2 b;
  std::uint32_t row;
  bool solid_left;
  double z_min, z_max;  ///< [m]

  bool is_at(double z) const { return z_min <= z && z < z_max; }
};

/// Immutable after construction and thread-safe.
class WallIndex {
 public:
  /// `walls` may be destroyed after construction.
  explicit WallIndex(std::span<const world::Segment> walls);

  const std::vector<IndexedWall>& segments() const { return segments_; }

  /// Finds every segment at height `z` [m] within `radius` [m] of `p`, and possibly others at that height.
  /// @param found out: indices into `segments()`, without duplicates, in unspecified order
  void near(glm::dvec2 p, double z, double radius, std::vector<std::uint32_t>& found) const;

  /// Returns whether `p` at height `z` [m] is in a solid, i.e. the winding number of all outlines with a known solid
  /// side is not 0. Within rounding of a surface, either result is possible.
  bool inside_solid(glm::dvec2 p, double z) const;

 private:
  /// Segments of solids in an interval of y, for winding numbers.
  struct Band {
    std::vector<std::uint32_t> from_left, from_right;  ///< sorted by ascending minimum x, and by descending maximum x
  };
  void index_bands();
  std::size_t band_of(double y) const;

  std::vector<IndexedWall> segments_;  ///< spatial neighbours are adjacent
  base::BoxTree tree_;
  std::vector<Band> bands_;
  double band_height_ = 1.0;  ///< [m]
};

}  // namespace sf::raycast
