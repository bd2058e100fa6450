#pragma once
// Merges several maps into one.

#include <span>
#include <string>

#include "maps/grid.h"

namespace sf::maps {

/// State of a cell in which maps differ.
enum class MergePolicy {
  occupied,  ///< occupied before free before unexplored: the safe choice for navigation
  newest,    ///< the state in the last map that explored the cell, so that moved obstacles disappear
};

/// The reason for which the maps cannot be merged (cells of different size, or too large a distance) and the remedy;
/// empty when they can.
std::string merge_problem(std::span<const OccupancyGrid* const> grids);

/// One map that covers all maps, on the lattice of the first. A cell of another map is assigned by its middle: exact
/// for aligned lattices, within half a cell otherwise.
/// Rule: at least one map, and an empty merge_problem.
OccupancyGrid merge(std::span<const OccupancyGrid* const> grids, MergePolicy precedence = MergePolicy::occupied);

}  // namespace sf::maps
