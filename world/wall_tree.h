#pragma once
// Geometry of segments, and a spatial index of walls. Built once. Queries do not allocate and are thread-safe.

#include <algorithm>
#include <span>
#include <vector>

#include "base/box_tree.h"
#include "base/pose.h"
#include "world/world.h"

namespace sf::world {

using base::Box;
using base::box_around;
using base::box_of;

/// Returns the bounding box of all segments; an empty box if there are none.
Box box_of(std::span<const Segment> segments);

/// Returns the vector [m] from the segment's nearest point to `p`.
inline glm::dvec2 from_segment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 along = b - a;
  const double size = dot(along, along);
  const double t = size > 0.0 ? std::clamp(dot(p - a, along) / size, 0.0, 1.0) : 0.0;
  return p - a - t * along;
}

/// Returns the distance [m] >= 0 from `p` to the nearest point of the segment.
double distance(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b);

/// Returns whether two closed segments share a point; touching counts.
bool segments_meet(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d);

/// Returns the number of turns of the outlines around `p`. Outlines run counter-clockwise around solids. Skips edges
/// without `solid_left`.
int winding_number(std::span<const Segment> edges, glm::dvec2 p);

class WallTree {
 public:
  /// @param walls copied
  explicit WallTree(std::span<const Segment> walls);

  /// Returns true as soon as `predicate(const Segment&)` is true for a wall whose bounding box meets `box`. Calls the
  /// predicate at most once per wall, in a fixed order.
  template <class Predicate>
  bool any(const Box& box, Predicate&& predicate) const {
    return tree_.any_place(box, [&](std::uint32_t place) {
      const Segment& wall = walls_[place];
      return meet(box, box_of(wall.a, wall.b)) && predicate(wall);
    });
  }

  std::span<const Segment> walls() const { return walls_; }
  Box extent() const { return tree_.extent(); }  ///< empty box if there are no walls

 private:
  std::vector<Segment> walls_;  ///< in the tree's order: neighbours are adjacent
  base::BoxTree tree_;
};

/// Same, for the walls of a tree for which `counts(const Segment&)` is true.
template <class Predicate>
int winding_number(const WallTree& walls, glm::dvec2 p, Predicate&& counts) {
  int sum = 0;  // over the edges crossed by a line from `p` to the right
  walls.any({p, {HUGE_VAL, p.y}}, [&](const Segment& wall) {
    if (counts(wall)) sum += winding_number(std::span(&wall, 1), p);
    return false;
  });
  return sum;
}

}  // namespace sf::world
