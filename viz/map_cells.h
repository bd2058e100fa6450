#pragma once
// Cells of an occupancy map in figures.

#include <cstdint>
#include <vector>

#include "maps/grid.h"
#include "maps/map_text.h"
#include "viz/legend.h"

namespace sf::viz {

/// One colour (ARGB) per cell, from the upper left one, row by row.
std::vector<std::uint32_t> pixels_of(const maps::OccupancyGrid& grid);

/// Each state with its share of all cells.
std::vector<LegendItem> state_legend(const maps::CellCounts& cells);

}  // namespace sf::viz
