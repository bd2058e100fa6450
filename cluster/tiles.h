#pragma once
// Tiles: a division of the plane into rectangles, one per rank.

#include <cstdint>
#include <span>
#include <vector>

#include "base/box.h"

namespace sf::cluster {

/// Halves the plane repeatedly, each time across the side along which the points extend farther, so that tiles have
/// about the same cost (recursive bisection: Berger and Bokhari, "A partitioning strategy for nonuniform problems on
/// multiprocessors", IEEE Trans. Comput. C-36, 1987). Equal arguments give equal tiles on all ranks.
class Tiles {
 public:
  /// @param points finite @param costs one per point, not negative @param count at least 1
  Tiles(std::span<const glm::dvec2> points, std::span<const double> costs, unsigned count);

  unsigned size() const { return static_cast<unsigned>(boxes_.size()); }
  /// Returns the tile of a point. Each point has exactly one, even on an edge.
  unsigned at(glm::dvec2 p) const;
  /// Returns tile k, which is infinite at the outer edges.
  const base::Box& operator[](unsigned k) const { return boxes_[k]; }
  /// Returns the distance [m] from a tile to a point; 0 inside.
  double distance(unsigned tile, glm::dvec2 p) const;

 private:
  struct Item {
    glm::dvec2 p;
    double cost = 0.0;
  };
  /// Points below the cut are in the tiles [first, middle), the others in [middle, last).
  struct Cut {
    unsigned middle = 0;
    int axis = 0;
    double at = 0.0;          ///< [m]
    std::uint32_t after = 0;  ///< the cut of the upper part; the next element is the cut of the lower part
  };
  void divide(std::span<Item> items, const base::Box& box, unsigned first, unsigned count);

  std::vector<Cut> cuts_;  ///< depth first
  std::vector<base::Box> boxes_;
};

}  // namespace sf::cluster
