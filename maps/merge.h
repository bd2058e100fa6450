#pragma once
// Several maps as one.

#include <span>
#include <string>

#include "maps/grid.h"

namespace sf::maps {

/// What a cell is where maps differ.
enum class Precedence {
  occupied,  ///< occupied beats free beats unexplored: nobody drives into what anybody saw
  newest,    ///< the last map that explored it is right: what moved away is gone
};

/// Why these maps cannot be merged (their cells differ in size, or they lie too far apart) and what to do; empty when
/// they can.
std::string refuse_merge(std::span<const Grid* const> grids);

/// One map that covers them all, on the lattice of the first: the middle of another's cell tells which of its cells it
/// is, which is exact where lattices agree, and within half a cell elsewhere.
/// Rule: at least one, and none refused.
Grid merge(std::span<const Grid* const> grids, Precedence precedence = Precedence::occupied);

}  // namespace sf::maps
