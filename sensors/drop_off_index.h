#pragma once
// Where there is no floor.

#include <span>
#include <vector>

#include "sensors/box_tree.h"
#include "world/world.h"

namespace sf::sensors {

/// Whether `p` is within the closed polygon `outline`, either winding. Decided by the sign of one product for each
/// edge: of polygons that share edges, exactly one holds a point on these.
bool holds(std::span<const glm::dvec2> outline, glm::dvec2 p);

/// The drops of a world, which must outlive it. Any thread.
class DropOffIndex {
 public:
  explicit DropOffIndex(std::span<const world::FloorHole> drops);
  /// True where one of them holds `p`.
  bool hold(glm::dvec2 p) const;

 private:
  std::span<const world::FloorHole> drop_offs_;
  BoxTree boxes_;
};

}  // namespace sf::sensors
