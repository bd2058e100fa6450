#pragma once
// Tiles: a division of the plane into rectangles, one per rank.

#include <cstdint>
#include <span>
#include <vector>

#include "base/box.h"

namespace sf::cluster {

/// The plane is halved again and again, each time across the side along which the points lie farther apart, so that
/// tiles have about the same cost (recursive bisection: Berger and Bokhari, "A partitioning strategy for nonuniform
/// problems on multiprocessors", IEEE Trans. Comput. C-36, 1987). Equal on all ranks for equal arguments.
class Tiles {
 public:
  /// @param points finite @param costs one per point, not negative @param count at least 1
  Tiles(std::span<const glm::dvec2> points, std::span<const double> costs, unsigned count);

  unsigned size() const { return static_cast<unsigned>(boxes_.size()); }
  /// The tile of a point; each point has one, also on an edge.
  unsigned at(glm::dvec2 p) const;
  /// Tile k, infinite at the outer edges.
  const base::Box& operator[](unsigned k) const { return boxes_[k]; }
  /// [m] From a tile to a point; 0 inside.
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
    std::uint32_t after = 0;  ///< the cut of the upper part; that of the lower part is the next one
  };
  void divide(std::span<Item> items, const base::Box& box, unsigned first, unsigned count);

  std::vector<Cut> cuts_;  ///< depth first
  std::vector<base::Box> boxes_;
};

}  // namespace sf::cluster
