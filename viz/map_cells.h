#pragma once
// Drawing of the cells of an occupancy map.

#include <array>
#include <cstdint>
#include <vector>

#include "maps/grid.h"
#include "maps/map_text.h"
#include "viz/legend.h"
#include "viz/picture_file.h"

namespace sf::viz {

/// Returns the colours of cells by their state.
const std::array<std::uint32_t, 4>& map_states(MapColors colors);

/// Returns one colour (ARGB) per cell, row by row from the upper left.
std::vector<std::uint32_t> pixels_of(const maps::OccupancyGrid& grid, MapColors colors);

/// Returns each state that occurs, with its share of all cells.
std::vector<LegendItem> state_legend(const maps::CellCounts& cells, MapColors colors);

}  // namespace sf::viz
