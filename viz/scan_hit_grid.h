#pragma once
// Occupancy from laser scans: cells that beams crossed, and cells in which they ended.
//
// A scan counts each cell once: as hit when a beam ended in it, else as passed when one crossed it. A cell is occupied
// when at least one in `kPassesPerHit` + 1 of its scans hit it. So a wall persists although beams graze it, and a robot
// that drove by disappears once enough scans pass through its place.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/pose.h"
#include "world/world.h"

namespace sf::viz {

enum class CellState : std::uint8_t { unexplored, occupied, free };

/// Only one thread at a time may add scans.
class ScanHitGrid {
 public:
  static constexpr std::uint32_t kPassesPerHit = 8;

  /// Cells cover `extent`; the last column and row may extend beyond it.
  /// @param cell [m] side of a cell, > 0; columns * rows must stay below 2^27
  ScanHitGrid(const world::Extent& extent, double cell);

  /// Adds one scan. Beam k has the bearing `bearing_min + k * bearing_increment` [rad] in the sensor's frame. A range
  /// in (range_min, range_max), or in [0, range_max) when range_min is 0, is an echo. A range of at least range_max
  /// (also infinity) has no echo and frees the cells up to range_max. Other values (NaN, negative, at most a range_min
  /// above 0: nearer than the sensor can measure) are skipped, as are cells outside the grid. An echo is counted 0.01
  /// cells behind its range, so that a wall on the border of two cells is in the cell behind its surface, whatever the
  /// rounding. Allocates nothing.
  /// @param moving empty, or one per range: 1 for an echo from a mover, which leaves no mark; the cells before it are
  /// free.
  void add_scan(const base::Pose& X_WS, std::span<const double> ranges, double bearing_min, double bearing_increment,
                double range_max, double range_min = 0.0, std::span<const std::uint8_t> moving = {});

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  double cell() const { return cell_; }  ///< [m]
  world::Extent extent() const;          ///< [m] of all cells
  /// @param column from the west in [0, columns), @param row from the south in [0, rows)
  CellState state(int column, int row) const;
  std::uint32_t hits(int column, int row) const { return at(column, row).hits; }
  std::uint32_t passes(int column, int row) const { return at(column, row).passes; }
  std::uint64_t cell_steps() const { return steps_; }  ///< number of cells visited by all beams so far

 private:
  struct Cell {
    std::uint16_t hits = 0;
    std::uint16_t passes = 0;  ///< both are halved when one would overflow
    std::uint32_t stamp = 0;   ///< number of the last scan that counted here, plus 1 for a hit
  };
  const Cell& at(int column, int row) const;
  void begin_scan();
  enum class End { mark, free, skip };                        // treatment of a beam's last cell
  void add_beam(glm::dvec2 from, glm::dvec2 along, End end);  // both in cells
  void hit(Cell& cell);
  void pass(Cell& cell);
  static void count(std::uint16_t& counter, Cell& cell);

  double x_min_, y_min_, cell_;
  int columns_, rows_;
  std::uint32_t scan_ = 0;  // even
  std::uint64_t steps_ = 0;
  std::vector<Cell> cells_;
};

/// Shares of the grid's area, in [0, 1]; their sum is 1.
struct AreaShares {
  double unexplored = 0.0, occupied = 0.0, free = 0.0;
};
AreaShares shares(const ScanHitGrid& grid);

/// The grid in the colours of Vernier's thesis (Virtual Sensor System, 2010, figure 44): unexplored dark grey, occupied
/// blue, free white.
/// @throws base::InputError naming the path when it cannot be written.
void draw_occupancy(const world::World& world, const ScanHitGrid& grid, const std::string& png_path);

}  // namespace sf::viz
