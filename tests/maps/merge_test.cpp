// Merged maps, and maps as text.

#include "maps/merge.h"

#include <gtest/gtest.h>

#include "maps/map_text.h"
#include "tests/sensors/chance.h"

namespace sf::maps {
namespace {

OccupancyGrid filled(const GridGeometry& geometry, std::uint64_t seed) {
  trial::Chance chance(seed);
  OccupancyGrid grid(geometry);
  for (std::int64_t row = 0; row < rows(geometry); ++row)
    for (std::int64_t column = 0; column < columns(geometry); ++column)
      grid.set({column, row}, static_cast<Cell>(chance.below(3)));
  return grid;
}

Cell at_point(const OccupancyGrid& grid, glm::dvec2 p) {
  const CellAt at = cell_at(grid.geometry, p);
  return contains(grid.geometry, at) ? grid.at(at) : Cell::unexplored;
}

TEST(Merge, SingleMapIsUnchanged) {
  const OccupancyGrid grid = filled({-1.2, 3.4, 0.5, 3, 2}, 1);
  const OccupancyGrid* const one[] = {&grid};
  EXPECT_EQ(merge(one).geometry, grid.geometry);
  EXPECT_EQ(merge(one).words, grid.words);
}

TEST(Merge, EveryCellComesFromItsMaps) {
  // Shifts by any number of whole cells, so that words are not aligned.
  trial::Chance chance(2);
  for (std::uint64_t k = 0; k < 40; ++k) {
    const auto shifted = [&](std::uint64_t seed) {
      const double dx = 0.5 * (static_cast<double>(chance.below(60)) - 30.0);
      const double dy = 0.5 * (static_cast<double>(chance.below(60)) - 30.0);
      return filled({dx, dy, 0.5, 1 + chance.below(5), 1 + chance.below(5)}, seed);
    };
    const OccupancyGrid a = shifted(3 * k + 10), b = shifted(3 * k + 11), c = shifted(3 * k + 12);
    const OccupancyGrid* const all[] = {&a, &b, &c};
    const OccupancyGrid careful = merge(all, MergePolicy::occupied);
    const OccupancyGrid newest = merge(all, MergePolicy::newest);
    CellCounts seen;
    for (std::int64_t row = 0; row < rows(careful.geometry); ++row)
      for (std::int64_t column = 0; column < columns(careful.geometry); ++column) {
        const glm::dvec2 p = middle(careful.geometry, {column, row});
        bool occupied = false;
        Cell last = Cell::unexplored;
        for (const OccupancyGrid* grid : all) {
          const Cell cell = at_point(*grid, p);
          occupied = occupied || cell == Cell::occupied;
          if (cell != Cell::unexplored) last = cell;
        }
        ASSERT_EQ(newest.at({column, row}), last);
        ASSERT_EQ(careful.at({column, row}), occupied ? Cell::occupied : last);
        if (last != Cell::unexplored) ++seen.free;
      }
    const CellCounts own = count(careful);
    EXPECT_EQ(own.free + own.occupied, seen.free);
    for (const OccupancyGrid* grid : all) {
      EXPECT_LE(careful.geometry.left, grid->geometry.left);
      EXPECT_GE(careful.geometry.top, grid->geometry.top);
    }
  }
}

TEST(Merge, RejectsIncompatibleMaps) {
  const OccupancyGrid a(GridGeometry{0, 0, 0.03, 2, 2}), coarse(GridGeometry{0, 0, 0.05, 2, 2}),
      far(GridGeometry{1e5, 0, 0.03, 2, 2});
  const OccupancyGrid* const cells[] = {&a, &coarse};
  EXPECT_NE(merge_problem(cells).find("cannot be merged"), std::string::npos);
  const OccupancyGrid* const places[] = {&a, &far};
  EXPECT_NE(merge_problem(places).find("far apart"), std::string::npos);
  const OccupancyGrid* const fine[] = {&a, &a};
  EXPECT_EQ(merge_problem(fine), "");
  // The largest valid coordinates.
  const OccupancyGrid one(GridGeometry{-1e7, 1e7, 1e-4, 1, 1}), other(GridGeometry{1e7, -1e7, 1e-4, 1, 1});
  const OccupancyGrid* const ends[] = {&one, &other};
  EXPECT_NE(merge_problem(ends), "");
}

TEST(MapText, MatchesTheThesis) {
  OccupancyGrid grid(GridGeometry{0, 0, 1, 1, 1});
  grid.set({0, 0}, Cell::occupied);
  grid.set({3, 0}, Cell::free);
  grid.set({1, 3}, Cell::free);
  EXPECT_EQ(grid_text(grid), "100 \n0000\n0000\n0 00\n");
  EXPECT_EQ(grid.words[0], 1u | 2u << 6 | 2u << 26) << "figure 42: rows of four, two bits each";
}

TEST(MapText, FitsTheTerminal) {
  const OccupancyGrid grid = filled({0, 0, 1, 5, 3}, 5);  // 20 x 12
  EXPECT_EQ(text_within(grid, 20, 12), grid_text(grid));
  const std::string half = text_within(grid, 10, 99);
  EXPECT_EQ(half.size(), 6u * 11u);
  for (std::int64_t row = 0; row < 6; ++row)
    for (std::int64_t column = 0; column < 10; ++column) {
      bool occupied = false, free = false;
      for (int k = 0; k < 4; ++k) {
        const Cell cell = grid.at({2 * column + k % 2, 2 * row + k / 2});
        occupied = occupied || cell == Cell::occupied;
        free = free || cell == Cell::free;
      }
      EXPECT_EQ(half[static_cast<std::size_t>(11 * row + column)], occupied ? '1' : free ? ' ' : '0');
    }
  EXPECT_EQ(text_within(grid, 3, 1).size(), 3u) << "12 rows in one: squares of 12 cells, two across, and a new line";
}

}  // namespace
}  // namespace sf::maps
