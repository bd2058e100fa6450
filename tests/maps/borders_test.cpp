// Maps as lines.

#include "maps/borders.h"

#include <gtest/gtest.h>

namespace sf::maps {

/// 16 x 16 cells, every second one of every second row occupied: 64 squares of four lines, and none at twice the side,
/// where each cell has one of them.
TEST(MapBorders, ManyLinesAreThoseOfLargerCells) {
  OccupancyGrid grid({.left = 1.0, .top = 2.0, .cell = 0.5, .word_columns = 4, .word_rows = 4});
  for (std::int64_t row = 0; row < 16; row += 2)
    for (std::int64_t column = 0; column < 16; column += 2) grid.set({column, row}, Cell::occupied);
  EXPECT_EQ(borders_of(grid, 256).occupied.size(), 256u);
  const MapBorders coarse = borders_of(grid, 255);
  ASSERT_EQ(coarse.occupied.size(), 4u);
  EXPECT_EQ(coarse.occupied[0], (MapBorders::Line{{{1.0, 2.0}, {9.0, 2.0}}}));
  EXPECT_EQ(coarse.explored, coarse.occupied);
}

/// Three words, an odd number, which are extended by unexplored cells. Each larger cell has one occupied cell, before
/// or after its free ones.
TEST(MapBorders, OccupiedWinsAmongTheCellsOfALargerOne) {
  OccupancyGrid grid({.left = 0.0, .top = 0.0, .cell = 1.0, .word_columns = 3, .word_rows = 1});
  for (CellAt at; at.row < 4; ++at.row)
    for (at.column = 0; at.column < 12; ++at.column) {
      const std::int64_t corner = at.column / 2 % 2;
      grid.set(at, at.column % 2 == corner && at.row % 2 == corner ? Cell::occupied : Cell::free);
    }
  const MapBorders coarse = borders_of(grid, 16);
  ASSERT_EQ(coarse.occupied.size(), 4u);
  EXPECT_EQ(coarse.occupied[0], (MapBorders::Line{{{0.0, 0.0}, {12.0, 0.0}}}));
  EXPECT_EQ(coarse.occupied[1], (MapBorders::Line{{{0.0, -4.0}, {12.0, -4.0}}}));
}

}  // namespace sf::maps
