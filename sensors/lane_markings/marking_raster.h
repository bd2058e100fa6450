#pragma once
// Road paint in pixels: cell (i, j) covers [i h, (i + 1) h) x [j h, (j + 1) h) of the world and is painted when its
// centre lies in a stripe. Two levels: blocks of 8 x 8 cells, and a directory that says of every block where its cells
// are, or how far it is to a block that has some.

#include <cstdint>
#include <vector>

#include "world/world.h"

namespace sf::sensors {

/// Immutable once made.
class MarkingRaster {
 public:
  static constexpr int kBlock = 8;                    ///< [cells] a block's side
  static constexpr std::uint32_t kFull = 0x80000000;  ///< of a directory word: the rest is a row of `blocks`

  /// @param cell [m] > 0. @param margin [m] empty space kept round all paint, at least.
  /// @throws base::InputError naming road_resolution, with `file`, when the raster would take more than `most_bytes`.
  MarkingRaster(const std::vector<world::LaneMarking>& lane_markings, double cell, double margin,
                const std::string& file, std::size_t most_bytes = std::size_t{1} << 29);

  double cell() const { return cell_; }                  ///< [m]
  std::int64_t first_column() const { return column_; }  ///< of the world's cells, the raster's first
  std::int64_t first_row() const { return row_; }
  std::uint32_t columns() const { return columns_; }  ///< [blocks]
  std::uint32_t rows() const { return rows_; }        ///< [blocks]

  /// A word per block, row by row: kFull and a row of `blocks`, or the chessboard distance to the nearest full block.
  const std::vector<std::uint32_t>& directory() const { return directory_; }
  /// Four words per full block: cells (x, y) in [0, 8) as bit x + 8 (y mod 4) of word y / 4; then those at dashes'
  /// ends.
  const std::vector<std::uint32_t>& blocks() const { return blocks_; }

  /// Of the raster's own cells, counted from its first.
  bool painted(std::int64_t x, std::int64_t y) const { return bit(x, y, 0); }
  bool at_end(std::int64_t x, std::int64_t y) const { return bit(x, y, 2); }

 private:
  bool bit(std::int64_t x, std::int64_t y, std::size_t plane) const;
  void set(std::int64_t x, std::int64_t y, std::size_t plane);
  void paint(const world::LaneMarking& marking);
  void measure_distances();

  double cell_;
  std::int64_t column_ = 0, row_ = 0;
  std::uint32_t columns_ = 1, rows_ = 1;
  std::vector<std::uint32_t> directory_;
  std::vector<std::uint32_t> blocks_;
};

}  // namespace sf::sensors
