#ifndef MAPS_GRID_H
#define MAPS_GRID_H
// An occupancy grid in the layout of the thesis (figure 42): two bits per cell, 4 x 4 cells in 32 bits.
//
// Cell (column, row) of word (C, R) is at bits 2 * (4 * (row % 4) + column % 4). Words are stored row by row. Columns
// grow along +x, rows along -y, as on a page. Included by C++ and GLSL.

#define SF_CELL_UNEXPLORED 0u
#define SF_CELL_OCCUPIED 1u
#define SF_CELL_FREE 2u

#ifdef __cplusplus

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/pose.h"

namespace sf::maps {

inline constexpr std::uint32_t kMaxWordColumns = 4096;  ///< also the limit of rows
inline constexpr std::uint32_t kMaxWords = 1u << 20;    ///< in one map: 4 MiB, 4096 x 4096 cells

/// State of a cell. The fourth two-bit value is unused.
enum class Cell : std::uint8_t { unexplored = SF_CELL_UNEXPLORED, occupied = SF_CELL_OCCUPIED, free = SF_CELL_FREE };

/// Position and size of a map.
/// The thesis' offset (O_x, O_y) (equations 9 and 10) is left = -O_x, top = -O_y.
struct GridGeometry {
  double left = 0.0;                ///< [m] in [-1e7, 1e7]: x of the first column's left side
  double top = 0.0;                 ///< [m] in [-1e7, 1e7]: y of the first row's upper side
  double cell = 0.03;               ///< [m] in [1e-4, 1e3]
  std::uint32_t word_columns = 30;  ///< in [1, kMaxWordColumns]: 4 cells each
  std::uint32_t word_rows = 30;     ///< same range; word_columns * word_rows <= kMaxWords
  bool operator==(const GridGeometry&) const = default;
};

inline std::int64_t columns(const GridGeometry& geometry) { return 4 * std::int64_t{geometry.word_columns}; }
inline std::int64_t rows(const GridGeometry& geometry) { return 4 * std::int64_t{geometry.word_rows}; }
inline std::uint32_t words(const GridGeometry& geometry) { return geometry.word_columns * geometry.word_rows; }

/// Returns true for a finite geometry within the limits above. No value derived from it can overflow.
inline bool is_valid(const GridGeometry& geometry) {
  constexpr double kFarthest = 1e7;  // [m]
  const bool placed = std::abs(geometry.left) <= kFarthest && std::abs(geometry.top) <= kFarthest;
  const bool sized = geometry.word_columns >= 1 && geometry.word_columns <= kMaxWordColumns &&
                     geometry.word_rows >= 1 && geometry.word_rows <= kMaxWordColumns &&
                     geometry.word_columns <= kMaxWords / geometry.word_rows;
  return placed && sized && geometry.cell >= 1e-4 && geometry.cell <= 1e3;
}

/// Returns true when each cell has one of the three states.
inline bool is_valid(std::uint32_t word) { return (word & (word >> 1) & 0x55555555u) == 0; }

/// Indices of a cell inside or outside the map.
struct CellAt {
  std::int64_t column = 0;
  std::int64_t row = 0;
  bool operator==(const CellAt&) const = default;
};

/// Returns the largest integer not above `value`; |value| <= 2^62.
inline std::int64_t whole_below(double value) {
  const auto cut = static_cast<std::int64_t>(value);
  return cut - (static_cast<double>(cut) > value ? 1 : 0);
}

/// Returns the cell that contains `p` (within 1e15 cells). All code uses this rule: floor((x - left) / cell),
/// floor((top - y) / cell), in double.
inline CellAt cell_at(const GridGeometry& geometry, glm::dvec2 p) {
  return {whole_below((p.x - geometry.left) / geometry.cell), whole_below((geometry.top - p.y) / geometry.cell)};
}

inline bool contains(const GridGeometry& geometry, CellAt at) {
  return at.column >= 0 && at.row >= 0 && at.column < columns(geometry) && at.row < rows(geometry);
}

/// Returns the centre of a cell [m].
inline glm::dvec2 middle(const GridGeometry& geometry, CellAt at) {
  return {geometry.left + (static_cast<double>(at.column) + 0.5) * geometry.cell,
          geometry.top - (static_cast<double>(at.row) + 0.5) * geometry.cell};
}

/// Returns the word of a cell, and the cell's place among its 16. Precondition: `contains(geometry, at)`.
inline std::size_t word_of(const GridGeometry& geometry, CellAt at) {
  return static_cast<std::size_t>(at.row / 4) * geometry.word_columns + static_cast<std::size_t>(at.column / 4);
}
inline unsigned place_of(CellAt at) { return static_cast<unsigned>(4 * (at.row % 4) + at.column % 4); }

/// An occupancy grid.
struct OccupancyGrid {
  GridGeometry geometry;
  std::vector<std::uint32_t> words;  ///< word_columns * word_rows

  explicit OccupancyGrid(const GridGeometry& p = {}) : geometry(p), words(std::size_t{p.word_columns} * p.word_rows) {}

  std::size_t word_of(CellAt at) const { return maps::word_of(geometry, at); }
  static unsigned shift_of(CellAt at) { return 2 * place_of(at); }

  /// Precondition: `contains(geometry, at)`.
  Cell at(CellAt at) const { return static_cast<Cell>((words[word_of(at)] >> shift_of(at)) & 3u); }
  void set(CellAt at, Cell cell) {
    std::uint32_t& word = words[word_of(at)];
    word = (word & ~(3u << shift_of(at))) | (static_cast<std::uint32_t>(cell) << shift_of(at));
  }
};

}  // namespace sf::maps

#endif
#endif
