#pragma once
// Cells of an occupancy map in figures.

#include <array>
#include <cstdint>
#include <vector>

#include "maps/grid.h"
#include "maps/map_text.h"
#include "viz/legend.h"
#include "viz/picture_file.h"

namespace sf::viz {

/// Colours of cells by their state.
const std::array<std::uint32_t, 4>& map_states(MapColors colors);

/// One colour (ARGB) per cell, from the upper left one, row by row.
std::vector<std::uint32_t> pixels_of(const maps::OccupancyGrid& grid, MapColors colors);

/// Each state that some cell has, with its share of all cells.
std::vector<LegendItem> state_legend(const maps::CellCounts& cells, MapColors colors);

}  // namespace sf::viz
