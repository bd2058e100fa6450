#include "sensors/magnetic_field/magnet_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace sf::sensors {

namespace {

// Rows are coarse because each costs a span. Columns are fine because they cost only memory.
constexpr double kRowsPerCutoff = 4.0;
constexpr double kColumnsPerCutoff = 16.0;

/// Returns a few ulps of a coordinate [m]: the rounding error of a row's edge.
double rounding(double a, double b) { return 8.0 * std::numeric_limits<double>::epsilon() * (std::abs(a) + b); }

}  // namespace

void MagnetGrid::measure(std::span<const glm::dvec2> magnets, double cutoff, std::size_t most_cells) {
  glm::dvec2 high = low_ = magnets.empty() ? glm::dvec2{} : magnets.front();
  for (const glm::dvec2& p : magnets) {
    low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  width_ = cutoff / kColumnsPerCutoff;
  depth_ = cutoff / kRowsPerCutoff;
  const double most = static_cast<double>(most_cells);
  for (;;) {
    const double across = std::floor((high.x - low_.x) / width_) + 1.0;
    const double rows = std::floor((high.y - low_.y) / depth_) + 1.0;
    across_ = static_cast<std::uint32_t>(std::min(across, most));
    rows_ = static_cast<std::uint32_t>(std::min(rows, most));
    if (across * rows <= most) return;
    (across > rows ? width_ : depth_) *= 2.0;
  }
}

double MagnetGrid::column_of(double x) const { return std::floor((x - low_.x) / width_); }
double MagnetGrid::row_of(double y) const { return std::floor((y - low_.y) / depth_); }

void MagnetGrid::build(std::span<const glm::dvec2> magnets, double cutoff, std::size_t most_cells) {
  order_.resize(magnets.size());
  std::iota(order_.begin(), order_.end(), 0u);
  whole_ = cutoff == 0.0;
  if (whole_) return;
  measure(magnets, cutoff, most_cells);

  starts_.assign(std::size_t{across_} * rows_ + 1, 0);
  cells_.resize(magnets.size());
  for (std::size_t i = 0; i < magnets.size(); ++i) {
    const auto column = static_cast<std::uint32_t>(column_of(magnets[i].x));
    cells_[i] = static_cast<std::uint32_t>(row_of(magnets[i].y)) * across_ + column;
    ++starts_[cells_[i] + 1];
  }
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());

  // Filling moves each cell's start to the next cell's start. All starts are moved back afterwards.
  for (std::uint32_t i = 0; i < magnets.size(); ++i) order_[starts_[cells_[i]]++] = i;
  std::move_backward(starts_.begin(), starts_.end() - 1, starts_.end());
  starts_.front() = 0;
}

std::uint32_t MagnetGrid::most_spans(double reach) const {
  if (order_.empty()) return 0;
  if (whole_) return 1;
  return static_cast<std::uint32_t>(std::min(2.0 * reach / depth_ + 3.0, static_cast<double>(rows_)));
}

std::uint32_t MagnetGrid::find(glm::dvec2 centre, double reach, std::span<MagnetSpan> out) const {
  if (order_.empty()) return 0;
  if (whole_) {
    out[0] = {0, static_cast<std::uint32_t>(order_.size())};
    return 1;
  }
  const double last_row = rows_ - 1.0;
  const double last_column = across_ - 1.0;
  const double row_end = std::min(row_of(centre.y + reach), last_row);
  std::uint32_t count = 0;
  for (double row = std::max(row_of(centre.y - reach), 0.0); row <= row_end; row += 1.0) {
    const double y = low_.y + row * depth_;
    const double apart = std::max({0.0, y - centre.y, centre.y - (y + depth_)}) - rounding(centre.y, std::abs(y));
    const double chord = std::sqrt(std::max(0.0, reach * reach - std::max(0.0, apart) * std::max(0.0, apart)));
    const double from = column_of(centre.x - chord);
    const double to = column_of(centre.x + chord);
    if (to < 0.0 || from > last_column) continue;
    const std::size_t cells = static_cast<std::size_t>(row) * across_;
    const std::uint32_t first = starts_[cells + static_cast<std::size_t>(std::max(from, 0.0))];
    const std::uint32_t end = starts_[cells + static_cast<std::size_t>(std::min(to, last_column)) + 1];
    if (first == end) continue;
    const bool joins = count > 0 && out[count - 1].end == first;
    if (joins) out[count - 1].end = end;
    if (!joins) out[count++] = {first, end};
  }
  return count;
}

}  // namespace sf::sensors
