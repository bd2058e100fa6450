#pragma once
// Adds scans to a map, one at a time, on the host. The device's result is bitwise equal. Each thread keeps up to 4 MiB
// of scratch memory (maps/scan_raster.h).
//
// The rule follows the thesis (4.4.3). The end of a beam is the cell of the point at its range (equations 9 and 10).
// The line from the sensor's cell to the end is free: with n = max(|dc|, |dr|) steps along the longer axis (columns
// when equal), step i has the offset (i * d / n) along the other axis, rounded to the nearest cell, halves away from
// the sensor's cell (equations 11 and 12 in integers). A range below range_max makes the end occupied; otherwise the
// end at range_max is free. Within one scan, occupied takes precedence over free. A later scan overwrites the cells
// that it covers. Cells outside the map are skipped, but a beam that leaves the map is still traced.
//
// Deviation from the thesis: it sets each beam's cells in turn, so a later beam may overwrite the end of an earlier
// one.

#include <cstdint>
#include <span>
#include <vector>

#include "maps/grid.h"
#include "maps/traced_scan.h"

namespace sf::maps {

void add_scan(OccupancyGrid& grid, const ScanView& scan);

/// Same for a traced scan.
void add_traced_scan(OccupancyGrid& grid, const TracedScan& scan, std::span<const std::uint32_t> ends);

/// Change of a cell's log odds by one scan, in integer units of the user's choice (1/100 by default).
struct LogOddsUpdate {
  std::int32_t hit = 85;     ///< added at the end of a beam; in [0, 32767]
  std::int32_t miss = 40;    ///< subtracted where beams only pass through; in [0, 32767]
  std::int32_t limit = 350;  ///< in [1, 32767]: log odds are clamped to +-limit, so that later scans can still change a
                             ///< cell
  bool operator==(const LogOddsUpdate&) const = default;
};

/// Returns the state of a cell by its log odds.
inline std::uint8_t state_of(std::int32_t odds) {
  return odds > 0 ? SF_CELL_OCCUPIED : odds < 0 ? SF_CELL_FREE : SF_CELL_UNEXPLORED;
}

/// A map of log odds per cell: word by word as in OccupancyGrid, and in bit order within a word. 0 means unknown.
struct LogOddsGrid {
  GridGeometry geometry;
  LogOddsUpdate rule;
  std::vector<std::int16_t> cells;   ///< 16 per word, within +-limit
  std::vector<std::uint32_t> words;  ///< as in OccupancyGrid: occupied if the odds are above 0, free if below,
                                     ///< unexplored at 0

  LogOddsGrid(const GridGeometry& p, const LogOddsUpdate& r)
      : geometry(p), rule(r), cells(16 * std::size_t{maps::words(p)}), words(maps::words(p)) {}
};

/// Updates each cell that the scan covers once: as occupied if a beam ends there, otherwise as free.
void add_scan(LogOddsGrid& grid, const ScanView& scan);
void add_traced_scan(LogOddsGrid& grid, const TracedScan& scan, std::span<const std::uint32_t> ends);

OccupancyGrid to_occupancy(const LogOddsGrid& grid);

}  // namespace sf::maps
