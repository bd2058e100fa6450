#pragma once
// Adds scans to a map, one at a time, on the host. The device's result is bitwise equal. Each thread keeps up to 4 MiB
// of scratch memory (maps/scan_raster.h).
//
// The rule, after the thesis (4.4.3). The end of a beam is the cell of the point at its range (equations 9 and 10). The
// line from the sensor's cell to the end is free: with n = max(|dc|, |dr|) steps along the longer axis (columns when
// equal), step i has the offset (i * d / n) along the other axis, rounded to the nearest cell, halves away from the
// sensor's cell (equations 11 and 12 in whole numbers). A range below range_max makes the end occupied; otherwise the
// end at range_max is free. Within one scan occupied takes precedence over free; a later scan overwrites the cells that
// it covers. Cells outside the map are skipped; beams that leave the map are not.
//
// Deviation: the thesis sets each beam's cells in turn, so a later beam may overwrite the end of an earlier one.

#include <cstdint>
#include <span>
#include <vector>

#include "maps/grid.h"
#include "maps/traced_scan.h"

namespace sf::maps {

void add_scan(OccupancyGrid& grid, const ScanView& scan);

/// The same for a traced scan.
void add_traced_scan(OccupancyGrid& grid, const TracedScan& scan, std::span<const std::uint32_t> ends);

/// Change of a cell's log odds by one scan, in integer units of the user's choice (by default 1/100).
struct LogOddsUpdate {
  std::int32_t hit = 85;     ///< added at the end of a beam; in [0, 32767]
  std::int32_t miss = 40;    ///< subtracted where beams only pass; in [0, 32767]
  std::int32_t limit = 350;  ///< in [1, 32767]: log odds stay within +-limit, so that later scans can change a cell
  bool operator==(const LogOddsUpdate&) const = default;
};

/// A map of log odds per cell, word by word as in OccupancyGrid, within a word in the order of its bits. 0: unknown.
struct LogOddsGrid {
  GridGeometry geometry;
  LogOddsUpdate rule;
  std::vector<std::int16_t> cells;   ///< 16 a word, within +-limit
  std::vector<std::uint32_t> words;  ///< as of OccupancyGrid: occupied above 0, free below, unexplored at 0

  LogOddsGrid(const GridGeometry& p, const LogOddsUpdate& r)
      : geometry(p), rule(r), cells(16 * std::size_t{maps::words(p)}), words(maps::words(p)) {}
};

/// Updates each cell that the scan covers once: as occupied, or else as free.
void add_scan(LogOddsGrid& grid, const ScanView& scan);
void add_traced_scan(LogOddsGrid& grid, const TracedScan& scan, std::span<const std::uint32_t> ends);

OccupancyGrid to_occupancy(const LogOddsGrid& grid);

}  // namespace sf::maps
