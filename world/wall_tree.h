#pragma once
// Geometry of segments, and the index of walls near a position. Built once; queries allocate nothing and may run on any
// thread.

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

/// Box of all segments; the box of no point without any.
Box box_of(std::span<const Segment> segments);

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

class WallTree {
 public:
  /// @param walls copied
  explicit WallTree(std::span<const Segment> walls);

  /// True as soon as `predicate(const Segment&)` is true for a wall whose bounding box meets `box`. The predicate is
  /// called at most once per wall; the order is fixed.
  template <class Predicate>
  bool any(const Box& box, Predicate&& predicate) const {
    return tree_.any_place(box, [&](std::uint32_t place) {
      const Segment& wall = walls_[place];
      return meet(box, box_of(wall.a, wall.b)) && predicate(wall);
    });
  }

  std::span<const Segment> walls() const { return walls_; }
  Box extent() const { return tree_.extent(); }  ///< the box of no point without walls

 private:
  std::vector<Segment> walls_;  ///< neighbours stand together
  base::BoxTree tree_;
};

/// The same of those walls of a tree for which `counts(const Segment&)` is true.
template <class Predicate>
int winding_number(const WallTree& walls, glm::dvec2 p, Predicate&& counts) {
  int sum = 0;  // of the edges that a line from `p` to the right crosses
  walls.any({p, {HUGE_VAL, p.y}}, [&](const Segment& wall) {
    if (counts(wall)) sum += winding_number(std::span(&wall, 1), p);
    return false;
  });
  return sum;
}

}  // namespace sf::world
