#pragma once
// Spatial index of floor holes.

#include <span>
#include <vector>

#include "sensors/box_tree.h"
#include "world/world.h"

namespace sf::sensors {

/// True when `p` is inside the closed polygon `outline`, of either winding. Each edge is decided by the sign of one
/// product: among polygons that share edges, exactly one contains a point on them.
bool holds(std::span<const glm::dvec2> outline, glm::dvec2 p);

/// The holes of a world, which must outlive this object. Thread-safe.
class DropOffIndex {
 public:
  explicit DropOffIndex(std::span<const world::FloorHole> drops);
  /// True when a hole contains `p`.
  bool hold(glm::dvec2 p) const;

 private:
  std::span<const world::FloorHole> drop_offs_;
  BoxTree boxes_;
};

}  // namespace sf::sensors
