#pragma once
// Road markings as pixels. Cell (i, j) covers [i h, (i + 1) h) x [j h, (j + 1) h) of the world and is painted when its
// centre is in a marking. There are two levels: blocks of 8 x 8 cells, and a directory that holds the cells of each
// block or its distance to the nearest block with paint.

#include <cstdint>
#include <vector>

#include "world/world.h"

namespace sf::sensors {

/// Immutable after construction and thread-safe.
class MarkingRaster {
 public:
  static constexpr int kBlock = 8;                    ///< [cells] side of a block
  static constexpr std::uint32_t kFull = 0x80000000;  ///< flag of a directory word; the other bits are a row in
                                                      ///< `blocks`

  /// @param cell [m] > 0  @param margin [m] smallest empty border around all paint
  /// @throws base::InputError that names road_resolution and `file` when the raster would exceed `most_bytes`
  MarkingRaster(const std::vector<world::LaneMarking>& lane_markings, double cell, double margin,
                const std::string& file, std::size_t most_bytes = std::size_t{1} << 29);

  double cell() const { return cell_; }                  ///< [m]
  std::int64_t first_column() const { return column_; }  ///< column of the raster's first cell, in the world's cells
  std::int64_t first_row() const { return row_; }
  std::uint32_t columns() const { return columns_; }  ///< [blocks]
  std::uint32_t rows() const { return rows_; }        ///< [blocks]

  /// One word per block, row by row: kFull and a row in `blocks`, or the chessboard distance [blocks] to the nearest
  /// full block.
  const std::vector<std::uint32_t>& directory() const { return directory_; }
  /// Four words per full block. Words 0 and 1: cells (x, y) in [0, 8) as bit x + 8 (y mod 4) of word y / 4. Words 2 and
  /// 3: cells at the ends of dashes, in the same layout.
  const std::vector<std::uint32_t>& blocks() const { return blocks_; }

  /// Cells are counted from the raster's first cell.
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
