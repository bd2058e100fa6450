#pragma once
// A map as lines, to draw it over other pictures.

#include <array>
#include <cstddef>
#include <glm/ext/vector_double2.hpp>
#include <vector>

#include "maps/grid.h"

namespace sf::maps {

/// Lines [m] in the map's frame along borders of cells. Neighbouring pieces of one line are joined.
struct MapBorders {
  using Line = std::array<glm::dvec2, 2>;
  std::vector<Line> occupied;  ///< between occupied cells and others
  std::vector<Line> explored;  ///< between explored cells and unexplored ones, or the map's edge
};

/// Returns the borders of a valid map. If one kind has more than `most` lines, both are those of the map in cells of
/// twice the side, and so on: such a cell is occupied if any of its four is, else free if any is.
/// @param most >= 16
MapBorders borders_of(const OccupancyGrid& grid, std::size_t most);

}  // namespace sf::maps
