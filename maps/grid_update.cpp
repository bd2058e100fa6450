#include "maps/grid_update.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace sf::maps {

namespace {

/// Frees all cells of one beam's line. `inside`: the whole line is inside the map.
void free_line(OccupancyGrid& grid, CellAt sensor, std::int32_t columns, std::int32_t rows, bool inside) {
  const bool flat = std::abs(columns) >= std::abs(rows);
  const std::int32_t steps = std::abs(flat ? columns : rows);
  const std::int32_t aside = std::abs(flat ? rows : columns);
  const CellAt along = flat ? CellAt{columns < 0 ? -1 : 1, 0} : CellAt{0, rows < 0 ? -1 : 1};
  const CellAt across = flat ? CellAt{0, rows < 0 ? -1 : 1} : CellAt{columns < 0 ? -1 : 1, 0};
  CellAt at = sensor;
  // floor((2 i aside + steps) / (2 steps)), kept as quotient (in `at`) and remainder.
  std::int32_t rest = steps;
  for (std::int32_t i = 0; i <= steps; ++i) {
    if (inside || contains(grid.geometry, at)) grid.set(at, Cell::free);
    at = {at.column + along.column, at.row + along.row};
    rest += 2 * aside;
    if (rest < 2 * steps) continue;
    rest -= 2 * steps;
    at = {at.column + across.column, at.row + across.row};
  }
}

}  // namespace

void add_traced_scan(OccupancyGrid& grid, const TracedScan& scan, std::span<const std::uint32_t> ends) {
  const CellBox part = intersect(scan.box, cells_of(grid.geometry));
  if (is_empty(part)) return;
  const bool inside = part.low == scan.box.low && part.high == scan.box.high;
  for (const std::uint32_t end : ends) free_line(grid, scan.sensor, columns_of(end), rows_of(end), inside);
  for (const std::uint32_t end : ends) {
    const CellAt at{scan.sensor.column + columns_of(end), scan.sensor.row + rows_of(end)};
    if (hit_of(end) && (inside || contains(grid.geometry, at))) grid.set(at, Cell::occupied);
  }
}

void add_scan(OccupancyGrid& grid, const ScanView& scan) {
  std::vector<std::uint32_t> ends(scan.ranges.size());
  add_traced_scan(grid, trace_scan(grid.geometry, scan, ends), ends);
}

void add_traced_scan(LogOddsGrid& grid, const TracedScan& scan, std::span<const std::uint32_t> ends,
                     OccupancyGrid& covered) {
  const CellBox part = intersect(scan.box, cells_of(grid.geometry));
  if (is_empty(part)) return;
  add_traced_scan(covered, scan, ends);
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

void add_scan(LogOddsGrid& grid, const ScanView& scan) {
  std::vector<std::uint32_t> ends(scan.ranges.size());
  OccupancyGrid covered(grid.geometry);
  add_traced_scan(grid, trace_scan(grid.geometry, scan, ends), ends, covered);
}

OccupancyGrid to_occupancy(const LogOddsGrid& grid) {
  OccupancyGrid states(grid.geometry);
  write_occupancy(grid, states);
  return states;
}

void write_occupancy(const LogOddsGrid& grid, OccupancyGrid& states) {
  std::fill(states.words.begin(), states.words.end(), 0u);
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const std::uint32_t state = grid.cells[i] > 0   ? SF_CELL_OCCUPIED
                                : grid.cells[i] < 0 ? SF_CELL_FREE
                                                    : SF_CELL_UNEXPLORED;
    states.words[i / 16] |= state << 2 * (i % 16);
  }
}

}  // namespace sf::maps
