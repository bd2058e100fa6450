#pragma once
// Converts scans to end cells. This is the only part of the rule (maps/grid_update.h) in floating point; it uses double
// and is shared by all mappers. All later steps use integers.

#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "maps/grid.h"

namespace sf::maps {

// Packs the end of a beam into one word: columns and rows from the sensor's cell, and whether the beam had an echo.

inline std::uint32_t pack_end(std::int64_t columns, std::int64_t rows, bool hit) {
  return (static_cast<std::uint32_t>(columns) & 0x7FFFu) | (static_cast<std::uint32_t>(rows) & 0x7FFFu) << 15 |
         (hit ? 1u << 30 : 0u);
}
inline std::int32_t columns_of(std::uint32_t end) { return static_cast<std::int32_t>(end << 17) >> 17; }
inline std::int32_t rows_of(std::uint32_t end) { return static_cast<std::int32_t>(end << 2) >> 17; }
inline bool hit_of(std::uint32_t end) { return (end >> 30 & 1u) != 0; }
inline std::uint32_t without_hit(std::uint32_t end) { return end & ~(1u << 30); }

/// One scan to be added to a map.
struct ScanView {
  base::Pose X_WS;                    ///< estimated pose of the sensor
  std::span<const double> ranges;     ///< [m]; NaN and negative values are ignored
  std::span<const glm::dvec2> beams;  ///< unit directions in the sensor's frame, one per range
  double range_min = 0.0;             ///< [m] ranges up to and including this value are ignored; if it is 0, a range of
                                      ///< 0 is valid
  double range_max = 0.0;             ///< [m] ranges of at least this value have no echo. Precondition: range_max <=
                                      ///< kMaxRangeCells cells
};

inline constexpr double kMaxRangeCells = 1'022.0;  ///< [cells] 30.6 m for cells of 3 cm

/// Returns the directions of bearings from -fov/2 to +fov/2, as in base::bearing_of. @param fov [rad] @param samples at
/// least 1
std::vector<glm::dvec2> beam_directions(double fov, std::uint32_t samples);

/// A half-open box of cells inside or outside the map; empty unless `low` is below `high` on both axes.
struct CellBox {
  CellAt low;
  CellAt high;
};
CellBox intersect(const CellBox& a, const CellBox& b);
inline bool is_empty(const CellBox& box) { return box.low.column >= box.high.column || box.low.row >= box.high.row; }
/// Returns the box of all cells of a map.
inline CellBox cells_of(const GridGeometry& geometry) { return {{0, 0}, {columns(geometry), rows(geometry)}}; }

/// A scan on the lattice of a map.
struct TracedScan {
  CellAt sensor;
  glm::dvec2 within;  ///< [cells] offset of the sensor from the centre of its cell, x along columns, y along rows: in
                      ///< [-.5, .5]
  CellBox box;  ///< bounds of all cells of the scan; empty if no range is valid or the sensor is too far from the map
};

/// Writes one end per range into `ends`. An invalid range gets the end of a valid one without its echo, which does not
/// change the map.
TracedScan trace_scan(const GridGeometry& geometry, const ScanView& scan, std::span<std::uint32_t> ends);

}  // namespace sf::maps
