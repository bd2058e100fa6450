#include "maps/map_text.h"

#include <algorithm>

namespace sf::maps {

namespace {

char sign_of(Cell cell) { return cell == Cell::occupied ? '1' : cell == Cell::free ? ' ' : '0'; }

/// Returns the state of a square of cells, ignoring cells outside the map.
Cell of_square(const OccupancyGrid& grid, std::int64_t column, std::int64_t row, std::int64_t side) {
  Cell all = Cell::unexplored;
  for (std::int64_t r = row; r < std::min(row + side, rows(grid.geometry)); ++r)
    for (std::int64_t c = column; c < std::min(column + side, columns(grid.geometry)); ++c) {
      const Cell cell = grid.at({c, r});
      if (cell == Cell::occupied) return cell;
      if (cell == Cell::free) all = cell;
    }
  return all;
}

std::string text_of_squares(const OccupancyGrid& grid, std::int64_t side) {
  std::string text;
  for (std::int64_t row = 0; row < rows(grid.geometry); row += side) {
    for (std::int64_t column = 0; column < columns(grid.geometry); column += side)
      text += sign_of(of_square(grid, column, row, side));
    text += '\n';
  }
  return text;
}

}  // namespace

std::string grid_text(const OccupancyGrid& grid) { return text_of_squares(grid, 1); }

std::string text_within(const OccupancyGrid& grid, int across, int down) {
  const auto squares = [](std::int64_t cells, int most) { return (cells + most - 1) / most; };
  return text_of_squares(grid, std::max(squares(columns(grid.geometry), across), squares(rows(grid.geometry), down)));
}

CellCounts count(const OccupancyGrid& grid) {
  CellCounts census;
  for (const std::uint32_t word : grid.words)
    for (unsigned shift = 0; shift < 32; shift += 2) {
      const auto cell = static_cast<Cell>(word >> shift & 3u);
      ++(cell == Cell::occupied ? census.occupied : cell == Cell::free ? census.free : census.unexplored);
    }
  return census;
}

}  // namespace sf::maps
