#pragma once
// Index of walls near a position: a hashed uniform grid with coarser levels for long walls.
//
// Memory is bounded by the number of walls, not by the extent of the world: a wall lies on the finest level on which it
// crosses few cells, and cells are buckets of one hash table. Built once; queries allocate nothing and may run on any
// thread.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/box.h"
#include "base/pose.h"
#include "world/world.h"

namespace sf::world {

using base::Box;
using base::box_around;
using base::box_of;

/// Vector from the segment's nearest point to `p`. [m]
inline glm::dvec2 from_segment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 along = b - a;
  const double size = dot(along, along);
  const double t = size > 0.0 ? std::clamp(dot(p - a, along) / size, 0.0, 1.0) : 0.0;
  return p - a - t * along;
}

/// Distance from `p` to the nearest point of the segment. [m] >= 0
double distance(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b);

/// Whether two closed segments share a point; touching counts.
bool segments_meet(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d);

/// Number of turns of the outlines round `p`; outlines run counter-clockwise around solids. Edges without `solid_left`
/// are skipped.
int winding_number(std::span<const Segment> edges, glm::dvec2 p);

class WallGrid {
 public:
  /// @param walls copied; the walls that queries return
  /// @param cell [m] > 0, edge of the finest cells: about the size of a typical query
  WallGrid(std::vector<Segment> walls, double cell);

  /// True as soon as `predicate(const Segment&)` is true for a wall whose bounding box meets `box`. The predicate may
  /// be called more than once for a wall; the order is fixed.
  template <class Predicate>
  bool any(const Box& box, Predicate&& predicate) const;

  std::span<const Segment> walls() const { return walls_; }

 private:
  struct Cells {
    std::int64_t x0, y0, x1, y1;
  };
  static std::int64_t cell_of(double v, double cell);
  static Cells cells_of(const Box& box, double cell);
  static bool meet(const Box& box, const Segment& wall);
  std::size_t bucket(std::uint32_t level, std::int64_t x, std::int64_t y) const;
  std::uint32_t level_of(const Segment& wall) const;
  template <class Visit>
  void for_each_bucket(const Segment& wall, Visit&& visit) const;
  void fill();

  std::vector<Segment> walls_;
  std::vector<double> cells_;           ///< [m] cell edge per level
  std::vector<std::uint32_t> used_;     ///< levels with at least one wall
  std::vector<std::uint32_t> starts_;   ///< per bucket, into entries_; one more at the end
  std::vector<std::uint32_t> entries_;  ///< rows of walls_
};

inline WallGrid::Cells WallGrid::cells_of(const Box& box, double cell) {
  return {cell_of(box.min.x, cell), cell_of(box.min.y, cell), cell_of(box.max.x, cell), cell_of(box.max.y, cell)};
}

inline bool WallGrid::meet(const Box& box, const Segment& wall) { return base::meet(box, box_of(wall.a, wall.b)); }

template <class Predicate>
bool WallGrid::any(const Box& box, Predicate&& predicate) const {
  for (const std::uint32_t level : used_) {
    const Cells cells = cells_of(box, cells_[level]);
    const double count = static_cast<double>(cells.x1 - cells.x0 + 1) * static_cast<double>(cells.y1 - cells.y0 + 1);
    if (count > static_cast<double>(walls_.size())) {
      return std::any_of(walls_.begin(), walls_.end(),
                         [&](const Segment& wall) { return meet(box, wall) && predicate(wall); });
    }
    for (std::int64_t y = cells.y0; y <= cells.y1; ++y) {
      for (std::int64_t x = cells.x0; x <= cells.x1; ++x) {
        const std::size_t at = bucket(level, x, y);
        for (std::uint32_t e = starts_[at]; e < starts_[at + 1]; ++e) {
          const Segment& wall = walls_[entries_[e]];
          if (meet(box, wall) && predicate(wall)) return true;
        }
      }
    }
  }
  return false;
}

}  // namespace sf::world
