#include "maps/scan_raster.h"

#include <algorithm>

namespace sf::maps {

namespace {

constexpr std::int64_t word_below(std::int64_t cell) { return cell >> 2; }

}  // namespace

void ScanRaster::lay_out(const TracedScan& scan) {
  first_column_ = word_below(scan.box.low.column);
  first_row_ = word_below(scan.box.low.row);
  width_ = static_cast<std::uint32_t>(word_below(scan.box.high.column + 3) - first_column_);
  height_ = static_cast<std::uint32_t>(word_below(scan.box.high.row + 3) - first_row_);
  sensor_column_ = static_cast<std::uint32_t>(scan.sensor.column - 4 * first_column_);
  sensor_row_ = static_cast<std::uint32_t>(scan.sensor.row - 4 * first_row_);
  if (cells_.size() < 16 * std::size_t{width_} * height_) cells_.resize(16 * std::size_t{width_} * height_);
  for (auto k = static_cast<std::uint32_t>(columns_.size()); k < 4 * width_; ++k)
    columns_.push_back(k / 4 * 16 + k % 4);
  rows_.resize(4 * std::size_t{height_});
  for (std::uint32_t k = 0; k < 4 * height_; ++k) rows_[k] = k / 4 * 16 * width_ + k % 4 * 4;
}

void ScanRaster::draw(std::span<const std::uint32_t> ends) {
  lines_.clear();
  drawn_ = 0;
  for (const std::uint32_t end : ends) {
    const std::uint32_t line = without_hit(end);
    if (!lines_.empty() && lines_.back() == line) continue;
    lines_.push_back(line);
    drawn_ += 1 + static_cast<std::size_t>(std::max(std::abs(columns_of(line)), std::abs(rows_of(line))));
    walk(line, [&](std::uint32_t place) { cells_[place] = SF_CELL_FREE; });
  }
  for (const std::uint32_t end : ends) {
    if (!hit_of(end)) continue;
    const auto column = static_cast<std::uint32_t>(static_cast<std::int32_t>(sensor_column_) + columns_of(end));
    const auto row = static_cast<std::uint32_t>(static_cast<std::int32_t>(sensor_row_) + rows_of(end));
    cells_[columns_[column] + rows_[row]] = SF_CELL_OCCUPIED;
  }
}

}  // namespace sf::maps
