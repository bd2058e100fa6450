#pragma once
// Merges several maps into one.

#include <span>
#include <string>

#include "maps/grid.h"

namespace sf::maps {

/// Decides the state of a cell in which the maps differ.
enum class MergePolicy {
  occupied,  ///< occupied wins over free, and free over unexplored: the safe choice for navigation
  newest,    ///< the last map that explored the cell wins, so moved obstacles disappear
};

/// Returns why the maps cannot be merged (cells of different size, or too large a distance) and the remedy; empty if
/// they can.
std::string merge_problem(std::span<const OccupancyGrid* const> grids);

/// Returns one map that covers all maps, on the lattice of the first. A cell of another map is assigned by its centre,
/// which is exact for aligned lattices and within half a cell otherwise.
/// Preconditions: at least one map, and merge_problem returns an empty text.
OccupancyGrid merge(std::span<const OccupancyGrid* const> grids, MergePolicy precedence = MergePolicy::occupied);

}  // namespace sf::maps
