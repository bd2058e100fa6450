#include "server/real_walls.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::server {

RealWalls::RealWalls(const world::World& world) {
  const world::Extent& extent = world.extent;
  const double width = extent.x_max - extent.x_min + 2.0 * kMargin,
               height = extent.y_max - extent.y_min + 2.0 * kMargin;
  cell_ = std::max(kCell, std::sqrt(width * height / static_cast<double>(kMostCells)));
  if (cell_ > kCoarsest) return;
  left_ = extent.x_min - kMargin;
  bottom_ = extent.y_min - kMargin;
  columns_ = static_cast<std::int64_t>(width / cell_);
  rows_ = static_cast<std::int64_t>(height / cell_);
}

/// J. Amanatides and A. Woo, A fast voxel traversal algorithm for ray tracing, Eurographics 1987.
template <class Visit>
void RealWalls::trace(const base::Pose& X_WS, double bearing, double range, Visit&& visit) const {
  const double place[] = {(X_WS.x - left_) / cell_, (X_WS.y - bottom_) / cell_};
  const glm::dvec2 way = base::direction(X_WS.yaw + bearing);
  const std::int64_t size[] = {columns_, rows_};
  std::int64_t at[2], step[2];
  double next[2], each[2];  // [m] to the next border, and between borders
  for (int k = 0; k < 2; ++k) {
    if (!(place[k] >= 0.0 && place[k] < static_cast<double>(size[k]))) return;
    at[k] = static_cast<std::int64_t>(place[k]);
    step[k] = way[k] < 0.0 ? -1 : 1;
    each[k] = way[k] == 0.0 ? HUGE_VAL : cell_ / std::abs(way[k]);
    const double share =
        way[k] < 0.0 ? place[k] - static_cast<double>(at[k]) : static_cast<double>(at[k]) + 1.0 - place[k];
    next[k] = way[k] == 0.0 ? HUGE_VAL : share * each[k];
  }
  for (double entered = 0.0; entered <= range;) {
    if (!visit(static_cast<std::size_t>(at[1] * columns_ + at[0]), entered)) return;
    const int k = next[0] < next[1] ? 0 : 1;
    entered = next[k];
    next[k] += each[k];
    at[k] += step[k];
    if (at[k] < 0 || at[k] >= size[k]) return;
  }
}

/// Cells with echoes first: a beam that grazes a wall passes through cells in which others end.
void RealWalls::add(const sensors::SensorSpec& laser, const base::Pose& X_WS, std::span<const double> ranges) {
  if (cells_.empty()) cells_.resize(static_cast<std::size_t>(columns_ * rows_));
  ++scan_;
  const auto last_cell = [&](std::size_t i) {
    std::size_t last = SIZE_MAX;
    trace(X_WS, sensors::bearing_of(laser, static_cast<std::uint32_t>(i)), ranges[i],
          [&](std::size_t at, double entered) {
            last = entered <= ranges[i] ? at : last;
            return true;
          });
    return last;
  };
  const auto is_echo = [&](double range) { return range > 0.0 && range < laser.limit; };
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const std::size_t at = is_echo(ranges[i]) ? last_cell(i) : SIZE_MAX;
    if (at == SIZE_MAX || cells_[at].scan == scan_) continue;
    cells_[at] = {scan_, static_cast<std::uint8_t>(std::min(cells_[at].score + kOccupied, int{kMostScore}))};
  }
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (!is_echo(ranges[i])) continue;
    trace(X_WS, sensors::bearing_of(laser, static_cast<std::uint32_t>(i)), ranges[i] - cell_,
          [&](std::size_t at, double) {
            Cell& cell = cells_[at];
            if (cell.scan != scan_) cell = {scan_, static_cast<std::uint8_t>(std::max(cell.score - 1, 0))};
            return true;
          });
  }
}

double RealWalls::cast(const base::Pose& X_WS, double bearing, double range) const {
  double found = range;
  trace(X_WS, bearing, range, [&](std::size_t at, double entered) {
    if (cells_[at].score < kOccupied) return true;
    found = std::min(range, entered);
    return false;
  });
  return found;
}

}  // namespace sf::server
