#pragma once
// A tree of magnets that bounds what those beyond a distance add, for all places of a box at once.

#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "sensors/magnetic_field/magnetic_field.h"
#include "world/world.h"

namespace sf::sensors {

/// Axis-aligned, closed.
struct Box {
  glm::dvec2 low, high;  ///< [m]
};

/// [T m^3] mu0 / 4 pi times its moment, as a magnitude.
double strength_of(const world::Magnet& magnet);

/// [T] largest field of a magnet of strength `k` [T m^3] at `along` [m] or farther on the ground and `above` [m] or
/// farther over it. @param along > 0.
double field_beyond(double k, double along, double above);

class MagnetTree {
 public:
  /// @param height [m] of all places.
  MagnetTree(std::span<const world::Magnet> magnets, double height);

  /// [T] at least the sum, at any place in `box`, of the magnitudes of all magnets farther than `cutoff` [m] > 0.
  double bound(const Box& box, double cutoff) const;
  Box extent() const;  ///< of the magnets; of the origin where there are none

 private:
  struct Node {
    Box box;
    double strength = 0.0;   ///< [T m^3] sum of magnitudes
    double above = 0.0;      ///< [m] least vertical distance
    std::uint32_t skip = 0;  ///< node behind this one and all below it
    bool leaf = false;       ///< one magnet
  };
  struct Item {
    glm::dvec2 p;
    double strength, above;
  };
  void build(std::span<Item> items);

  std::vector<Node> nodes_;  ///< depth first
};

}  // namespace sf::sensors
