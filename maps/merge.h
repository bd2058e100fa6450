#pragma once
// Several maps as one.

#include <span>
#include <string>

#include "maps/grid.h"

namespace sf::maps {

/// What a cell is where maps differ.
enum class MergePolicy {
  occupied,  ///< occupied beats free beats unexplored: nobody drives into what anybody saw
  newest,    ///< the last map that explored it is right: what moved away is gone
};

/// Why these maps cannot be merged (their cells differ in size, or they lie too far apart) and what to do; empty when
/// they can.
std::string merge_problem(std::span<const OccupancyGrid* const> grids);

/// One map that covers them all, on the lattice of the first: the middle of another's cell tells which of its cells it
/// is, which is exact where lattices agree, and within half a cell elsewhere.
/// Rule: at least one, and none refused.
OccupancyGrid merge(std::span<const OccupancyGrid* const> grids, MergePolicy precedence = MergePolicy::occupied);

}  // namespace sf::maps
