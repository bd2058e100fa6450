#pragma once
// Scans into a map, one at a time, on the host: the rule, and the reference that the device agrees with to the bit.
//
// The rule, after the thesis (4.4.3). Of each beam: its end is the cell of the point at its range (equations 9 and 10).
// The line from the sensor's cell to it is free: with n = max(|dc|, |dr|) steps along the longer side (columns where
// they are equal), step i is (i * d / n) to the other side, rounded to the nearest cell, halves away from the sensor's
// cell (equations 11 and 12 in whole numbers). A range below range_max makes the end occupied; any other leaves it
// free, at range_max. Within one scan occupied beats free; a later scan overwrites what it covers. Cells outside the
// map are left out, beams are not.
//
// Where we deviate from the thesis: it sets each beam's cells in turn, so a later beam may wipe out the end of an
// earlier one.

#include <cstdint>
#include <span>
#include <vector>

#include "maps/grid.h"
#include "maps/traced_scan.h"

namespace sf::maps {

void add_scan(OccupancyGrid& grid, const ScanView& scan);

/// The same of a scan that is traced already.
void add_traced_scan(OccupancyGrid& grid, const TracedScan& scan, std::span<const std::uint32_t> ends);

/// What one scan adds to a cell's log odds, in whole units of the user's own (a hundredth, by default).
struct LogOddsUpdate {
  std::int32_t hit = 85;     ///< added where a beam ended; in [0, 32767]
  std::int32_t miss = 40;    ///< taken off where beams only passed; in [0, 32767]
  std::int32_t limit = 350;  ///< in [1, 32767]: odds stay within +-limit, so that a map can change its mind
  bool operator==(const LogOddsUpdate&) const = default;
};

/// A map that weighs: log odds per cell, word by word as in Grid, within a word in the order of its bits. 0: not known.
struct LogOddsGrid {
  GridGeometry plan;
  LogOddsUpdate rule;
  std::vector<std::int16_t> cells;  ///< 16 a word

  LogOddsGrid(const GridGeometry& p, const LogOddsUpdate& r) : plan(p), rule(r), cells(16 * std::size_t{words(p)}) {}
};

/// Every cell that the scan covers is weighed once: as occupied, or else as free.
void add_scan(LogOddsGrid& grid, const ScanView& scan);
/// @param covered scratch of the same plan: unexplored before and after
void add_traced_scan(LogOddsGrid& grid, const TracedScan& scan, std::span<const std::uint32_t> ends,
                     OccupancyGrid& covered);

/// Occupied above 0, free below, unexplored at 0.
OccupancyGrid to_occupancy(const LogOddsGrid& grid);
/// @param states of the same plan: overwritten
void write_occupancy(const LogOddsGrid& grid, OccupancyGrid& states);

}  // namespace sf::maps
