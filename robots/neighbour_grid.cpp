#include "robots/neighbour_grid.h"

#include <algorithm>
#include <bit>

namespace sf::robots {

void NeighbourGrid::build(std::span<const base::Report> reports, double cell, const world::CopyIndex& copies) {
  cell_ = cell;
  starts_.assign(std::bit_ceil(2 * std::max<std::size_t>(reports.size(), 1)) + 1, 0);
  rows_.resize(reports.size());
  cells_.resize(reports.size());
  bucket_of_.resize(reports.size());

  const auto cell_at = [&](std::size_t row) {
    const base::Pose& X_WM = reports[row].X_WM;
    return Cell{cell_of(X_WM.x), cell_of(X_WM.y), copies.copy_of(static_cast<std::uint32_t>(row))};
  };
  // Counting sort. After the second pass, `starts_[at]` is the end of bucket `at - 1`, and so the start of bucket `at`.
  for (std::size_t row = 0; row < reports.size(); ++row) {
    const std::size_t at = bucket(cell_at(row));
    bucket_of_[row] = static_cast<std::uint32_t>(at);
    ++starts_[at];
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& start : starts_) start = sum += start;
  for (std::size_t row = reports.size(); row-- > 0;) {
    const std::uint32_t at = --starts_[bucket_of_[row]];
    rows_[at] = static_cast<std::uint32_t>(row);
    cells_[at] = cell_at(row);
  }
}

std::size_t NeighbourGrid::bucket(const Cell& cell) const {
  std::uint64_t h = static_cast<std::uint64_t>(cell.x) * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(cell.y) +
                    cell.copy * 0xD1B54A32D192ED03u;
  h = (h ^ (h >> 32)) * 0xBF58476D1CE4E5B9u;
  return (h ^ (h >> 29)) & (starts_.size() - 2);
}

}  // namespace sf::robots
