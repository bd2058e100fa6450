#pragma once
// A map as text, as the thesis prints it (figure 44): 0 unexplored, 1 occupied, blank free.

#include <string>

#include "maps/grid.h"

namespace sf::maps {

/// One line per row, trailing blanks kept.
std::string text_of(const OccupancyGrid& grid);

/// The same for a terminal of limited size: squares of cells are drawn as one character, occupied where any of them is,
/// else free where any is.
/// @param across, down characters to stay within, at least 1
std::string text_within(const OccupancyGrid& grid, int across, int down);

/// How many cells are in each state.
struct CellCounts {
  std::uint64_t unexplored = 0;
  std::uint64_t occupied = 0;
  std::uint64_t free = 0;
  std::uint64_t all() const { return unexplored + occupied + free; }
};
CellCounts count(const OccupancyGrid& grid);

}  // namespace sf::maps
