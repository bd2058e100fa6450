#pragma once
// Applies the update rule of maps (maps/grid_update.h) cell by cell: the reference for tests, and the baseline in
// benchmarks.

#include <algorithm>
#include <cstdlib>
#include <span>
#include <utility>
#include <vector>

#include "maps/grid_update.h"

namespace sf::trial {

using maps::CellAt;
using maps::CellBox;
using maps::OccupancyGrid;

/// Frees all cells of one beam's line. @param inside true if the whole line is inside the map
inline void free_line(OccupancyGrid& grid, CellAt sensor, std::int32_t columns, std::int32_t rows, bool inside) {
  const bool flat = std::abs(columns) >= std::abs(rows);
  const std::int32_t steps = std::abs(flat ? columns : rows);
  const std::int32_t aside = std::abs(flat ? rows : columns);
  const CellAt along = flat ? CellAt{columns < 0 ? -1 : 1, 0} : CellAt{0, rows < 0 ? -1 : 1};
  const CellAt across = flat ? CellAt{0, rows < 0 ? -1 : 1} : CellAt{columns < 0 ? -1 : 1, 0};
  CellAt at = sensor;
  // Computes floor((2 i aside + steps) / (2 steps)), kept as quotient (in `at`) and remainder.
  std::int32_t rest = steps;
  for (std::int32_t i = 0; i <= steps; ++i) {
    if (inside || contains(grid.geometry, at)) grid.set(at, maps::Cell::free);
    at = {at.column + along.column, at.row + along.row};
    rest += 2 * aside;
    if (rest < 2 * steps) continue;
    rest -= 2 * steps;
    at = {at.column + across.column, at.row + across.row};
  }
}

inline void add_plainly(OccupancyGrid& grid, const maps::TracedScan& scan, std::span<const std::uint32_t> ends) {
  const CellBox part = intersect(scan.box, cells_of(grid.geometry));
  if (is_empty(part)) return;
  const bool inside = part.low == scan.box.low && part.high == scan.box.high;
  for (const std::uint32_t end : ends) free_line(grid, scan.sensor, maps::columns_of(end), maps::rows_of(end), inside);
  for (const std::uint32_t end : ends) {
    const CellAt at{scan.sensor.column + maps::columns_of(end), scan.sensor.row + maps::rows_of(end)};
    if (maps::hit_of(end) && (inside || contains(grid.geometry, at))) grid.set(at, maps::Cell::occupied);
  }
}

/// Leaves `grid.words` unchanged. @param covered scratch map of the same geometry: unexplored before and after
inline void add_plainly(maps::LogOddsGrid& grid, const maps::TracedScan& scan, std::span<const std::uint32_t> ends,
                        OccupancyGrid& covered) {
  const CellBox part = intersect(scan.box, cells_of(grid.geometry));
  if (is_empty(part)) return;
  add_plainly(covered, scan, ends);
  for (std::int64_t row = part.low.row / 4; row <= (part.high.row - 1) / 4; ++row) {
    for (std::int64_t column = part.low.column / 4; column <= (part.high.column - 1) / 4; ++column) {
      const std::size_t word = covered.word_of({4 * column, 4 * row});
      std::int16_t* odds = &grid.cells[16 * word];
      for (std::uint32_t states = std::exchange(covered.words[word], 0u); states != 0; states >>= 2, ++odds) {
        if ((states & 3u) == SF_CELL_UNEXPLORED) continue;
        const std::int32_t more = (states & 3u) == SF_CELL_OCCUPIED ? grid.rule.hit : -grid.rule.miss;
        *odds = static_cast<std::int16_t>(std::clamp(*odds + more, -grid.rule.limit, grid.rule.limit));
      }
    }
  }
}

/// Occupied above 0, free below, unexplored at 0.
inline std::vector<std::uint32_t> plain_words(const maps::LogOddsGrid& grid) {
  std::vector<std::uint32_t> words(grid.words.size());
  for (std::size_t i = 0; i < grid.cells.size(); ++i)
    words[i / 16] |= (grid.cells[i] > 0 ? SF_CELL_OCCUPIED : grid.cells[i] < 0 ? SF_CELL_FREE : 0u) << 2 * (i % 16);
  return words;
}

}  // namespace sf::trial
