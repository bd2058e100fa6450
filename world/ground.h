#pragma once
// Heights of the ground: the floor at z = 0, and roads above it (World::ramps). Bodies stand on these, and spatial
// sensors see them (scene/solids.h); planar sensors do not.

#include <span>

#include "base/box_tree.h"
#include "base/pose.h"
#include "world/world.h"

namespace sf::world {

/// Immutable and thread-safe.
class Ground {
 public:
  /// `ramps` must outlive it.
  explicit Ground(std::span<const Ramp> ramps);

  bool is_flat() const { return ramps_.empty(); }
  /// Returns the height [m] of the highest surface at `p` that is at most `most` [m] high; 0: the floor.
  double height(glm::dvec2 p, double most) const;
  /// Returns the z [m] of a body after a move. On a surface (within 1 cm) it stays on it, and above a surface it keeps
  /// its height above it. It climbs a rise of at most kMostStep plus kMostSlope times the length of the move, passes
  /// under higher surfaces, and drops from an edge within the move.
  double follow(const base::Pose& from, glm::dvec2 to) const;

  static constexpr double kMostStep = 0.05;  ///< [m]
  static constexpr double kMostSlope = 0.5;
  /// [half widths] Pieces are this much longer at both ends, level, which closes the gaps between them on the outside
  /// of bends.
  static constexpr double kOverlap = 0.05;

 private:
  std::span<const Ramp> ramps_;
  base::BoxTree tree_;
};

/// Returns the height [m] of a mover at load above the surface below it.
double clearance_of(const World& world, const Mover& mover);
/// Returns the z [m] of a mover at `p` on the highest road of `world` there, with that clearance.
double height_on_road(const World& world, glm::dvec2 p, double clearance);

}  // namespace sf::world
