#pragma once
// A tree of magnets that bounds the field of all magnets beyond a distance, for all points of a box.

#include <span>
#include <vector>

#include "base/box_tree.h"
#include "sensors/magnetic_field/magnetic_field.h"
#include "world/world.h"

namespace sf::sensors {

/// Returns mu0 / 4 pi times the magnitude of the magnet's moment [T m^3].
double strength_of(const world::Magnet& magnet);

/// Returns the largest field [T] of a magnet of strength `k` [T m^3] at a distance of at least `along` [m] on the
/// ground and `above` [m] in height. @param along > 0
double field_beyond(double k, double along, double above);

class MagnetTree {
 public:
  /// @param height [m] of all points
  MagnetTree(std::span<const world::Magnet> magnets, double height);

  /// Returns an upper bound [T], at any point in `box`, of the sum of the magnitudes of all magnets farther than
  /// `cutoff` [m] > 0.
  double bound(const base::Box& box, double cutoff) const;
  base::Box extent() const { return tree_.extent(); }  ///< extent of the magnets, at least one

 private:
  /// The magnets of one node.
  struct Sum {
    double strength = 0.0;  ///< [T m^3] sum of magnitudes
    double above = 0.0;     ///< [m] smallest vertical distance
  };
  base::BoxTree tree_;     ///< one magnet per leaf
  std::vector<Sum> sums_;  ///< per node
};

}  // namespace sf::sensors
