#pragma once
// Scans as end cells: the part of the rule (maps/grid_update.h) that needs real numbers, in double, done once for
// everyone. What follows from it is whole numbers.

#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "maps/grid.h"

namespace sf::maps {

// Where a beam ends, in one word: how many columns and rows from the sensor's cell, and whether it met something there.

inline std::uint32_t pack_end(std::int64_t columns, std::int64_t rows, bool hit) {
  return (static_cast<std::uint32_t>(columns) & 0x7FFFu) | (static_cast<std::uint32_t>(rows) & 0x7FFFu) << 15 |
         (hit ? 1u << 30 : 0u);
}
inline std::int32_t columns_of(std::uint32_t end) { return static_cast<std::int32_t>(end << 17) >> 17; }
inline std::int32_t rows_of(std::uint32_t end) { return static_cast<std::int32_t>(end << 2) >> 17; }
inline bool hit_of(std::uint32_t end) { return (end >> 30 & 1u) != 0; }

/// One scan as a mapper needs it.
struct ScanView {
  base::Pose X_WS;                    ///< of the sensor, as the robot believes
  std::span<const double> ranges;     ///< [m]; what is not a number, or negative, says nothing
  std::span<const glm::dvec2> beams;  ///< unit directions in the sensor's frame, one per range
  double range_min = 0.0;             ///< [m] what is not farther says nothing; where 0, a range of 0 does
  double range_max = 0.0;             ///< [m] nothing was met from here on. Rule: range_max <= kMaxRangeCells cells
};

inline constexpr double kMaxRangeCells = 1'022.0;  ///< [cells] 30.6 m where a cell is 3 cm

/// Bearings from -fov/2 to +fov/2, as world::bearing_of has them. @param fov [rad] @param samples at least 1
std::vector<glm::dvec2> beam_directions(double fov, std::uint32_t samples);

/// A half-open box of cells, which may lie outside of the map; empty where `low` is not below `high`.
struct CellBox {
  CellAt low;
  CellAt high;
};
CellBox intersect(const CellBox& a, const CellBox& b);
inline bool is_empty(const CellBox& box) { return box.low.column >= box.high.column || box.low.row >= box.high.row; }
/// All of a map.
inline CellBox cells_of(const GridGeometry& plan) { return {{0, 0}, {columns(plan), rows(plan)}}; }

/// A scan on a map.
struct TracedScan {
  CellAt sensor;
  glm::dvec2
      within;   ///< [cells] of the sensor from the middle of its cell, x along columns, y along rows: in [-.5, .5]
  CellBox box;  ///< of all cells it speaks of; empty when it says nothing, or is too far away to be counted
};

/// Writes one end per range into `ends`. A beam that says nothing repeats one that does, which changes nothing.
TracedScan trace_scan(const GridGeometry& plan, const ScanView& scan, std::span<std::uint32_t> ends);

}  // namespace sf::maps
