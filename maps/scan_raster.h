#pragma once
// Rasterizes one scan, with one byte per cell. Lines and ends are drawn without reading the map, and each word of the
// map is changed once.

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "maps/grid.h"
#include "maps/traced_scan.h"

namespace sf::maps {

/// Scratch memory of one thread: up to 4 MiB. All cells are blank between scans.
class ScanRaster {
 public:
  /// Draws the lines of a scan as free and its hits as occupied (see the rule in maps/grid_update.h), then calls
  /// `visit(word, states)` for each word of the map that the scan covers.
  /// @param visit receives the index of a word and the states of its cells: 16 bytes, in the order of the word's bits
  template <class Visit>
  void add(const GridGeometry& geometry, const TracedScan& scan, std::span<const std::uint32_t> ends, Visit&& visit) {
    if (is_empty(intersect(scan.box, cells_of(geometry)))) return;
    lay_out(scan);
    draw(ends);
    if (std::size_t{width_} * height_ <= 2 * drawn_)
      visit_all(geometry, visit);
    else
      visit_lines(geometry, visit);
  }

 private:
  void lay_out(const TracedScan& scan);
  void draw(std::span<const std::uint32_t> ends);

  /// Calls `visit(place)` for each cell of a beam's line, from the sensor's cell to the end.
  template <class Visit>
  void walk(std::uint32_t end, Visit&& visit) const {
    const std::int32_t columns = columns_of(end), rows = rows_of(end);
    const bool flat = std::abs(columns) >= std::abs(rows);
    const std::int32_t far = flat ? columns : rows, aside = flat ? rows : columns;
    const std::uint32_t* along = (flat ? columns_.data() + sensor_column_ : rows_.data() + sensor_row_);
    const std::uint32_t* across = (flat ? rows_.data() + sensor_row_ : columns_.data() + sensor_column_);
    // Steps across, in units of 1/2^32 of a cell, rounded up. The sum of the errors over 1 022 steps is less than 1/(2
    // * 1 022), the smallest distance of an offset from the next half cell, so halves are still rounded away from the
    // sensor's cell.
    constexpr std::int64_t kOne = std::int64_t{1} << 32;
    const std::int32_t steps = std::abs(far), step = far < 0 ? -1 : 1;
    const double slope = steps > 0 ? static_cast<double>(std::abs(aside) * kOne) / steps : 0.0;
    const std::int64_t up = static_cast<std::int64_t>(slope) + 1, more = aside < 0 ? -up : up;
    std::int64_t offset = kOne / 2;
    for (std::int32_t i = 0, at = 0; i <= steps; ++i, at += step, offset += more)
      visit(along[at] + across[offset >> 32]);
  }

  template <class Visit>
  void visit_all(const GridGeometry& geometry, Visit& visit) {
    std::size_t block = 0;
    for (std::uint32_t row = 0; row < height_; ++row)
      for (std::uint32_t column = 0; column < width_; ++column) offer(geometry, block++, column, row, visit);
  }
  template <class Visit>
  void visit_lines(const GridGeometry& geometry, Visit& visit) {
    for (const std::uint32_t end : lines_)
      walk(end, [&](std::uint32_t place) {
        const std::uint32_t block = place / 16;
        offer(geometry, block, block % width_, block / width_, visit);
      });
  }
  /// Visits a block if it has cells of the scan inside the map, then blanks it.
  template <class Visit>
  void offer(const GridGeometry& geometry, std::size_t block, std::uint32_t column, std::uint32_t row, Visit& visit) {
    std::uint8_t* const states = &cells_[16 * block];
    std::array<std::uint64_t, 2> halves;
    std::memcpy(halves.data(), states, sizeof halves);
    if ((halves[0] | halves[1]) == 0) return;
    const std::int64_t c = first_column_ + column, r = first_row_ + row;
    if (c >= 0 && c < geometry.word_columns && r >= 0 && r < geometry.word_rows)
      visit(static_cast<std::size_t>(r) * geometry.word_columns + static_cast<std::size_t>(c), states);
    std::memset(states, 0, sizeof halves);
  }

  std::int64_t first_column_ = 0, first_row_ = 0;  ///< [words] in the map
  std::uint32_t width_ = 0, height_ = 0;           ///< [words]
  std::uint32_t sensor_column_ = 0, sensor_row_ = 0;
  std::vector<std::uint8_t> cells_;     ///< word by word, in bit order within a word
  std::vector<std::uint32_t> columns_;  ///< the place of a cell is the sum of its column's and its row's entries
  std::vector<std::uint32_t> rows_;
  std::vector<std::uint32_t> lines_;  ///< ends without their hits; neighbouring beams with the same end share one entry
  std::size_t drawn_ = 0;             ///< number of cells of these lines
};

}  // namespace sf::maps
