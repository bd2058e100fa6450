#pragma once
// A map as text in the format of the thesis (figure 44): 0 unexplored, 1 occupied, blank free.

#include <string>

#include "maps/grid.h"

namespace sf::maps {

/// One line per row, trailing blanks kept.
std::string grid_text(const OccupancyGrid& grid);

/// Same, scaled to a terminal of limited size. Each character represents a square of cells: occupied if any of its
/// cells is occupied, otherwise free if any is free.
/// @param across, down largest number of columns and lines, at least 1
std::string text_within(const OccupancyGrid& grid, int across, int down);

/// Number of cells in each state.
struct CellCounts {
  std::uint64_t unexplored = 0;
  std::uint64_t occupied = 0;
  std::uint64_t free = 0;
  std::uint64_t all() const { return unexplored + occupied + free; }
};
CellCounts count(const OccupancyGrid& grid);

}  // namespace sf::maps
