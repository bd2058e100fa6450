#include "viz/scan_hit_grid.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace sf::viz {
namespace {

constexpr double kMaxCells = 1 << 27;

/// [cells] offset of an echo behind its range: a wall on the border of two cells is then always in the cell behind its
/// surface, whatever the rounding of each range.
constexpr double kBehindSurface = 0.01;

int cells_along(double from, double to, double cell) {
  return static_cast<int>(std::min(std::max(1.0, std::ceil((to - from) / cell - 1e-6)), kMaxCells + 1.0));
}

/// Clips [t0, t1] to a + t * d in [0, end] (Liang and Barsky, 1984).
void narrow(double a, double d, double end, double& t0, double& t1) {
  if (d == 0.0) {
    if (a < 0.0 || a > end) t1 = -1.0;
    return;
  }
  const double at_0 = -a / d;
  const double at_end = (end - a) / d;
  t0 = std::max(t0, std::min(at_0, at_end));
  t1 = std::min(t1, std::max(at_0, at_end));
}

int cell_index(double x, int count) { return std::clamp(static_cast<int>(std::floor(x)), 0, count - 1); }

}  // namespace

ScanHitGrid::ScanHitGrid(const world::Extent& extent, double cell)
    : x_min_(extent.x_min),
      y_min_(extent.y_min),
      cell_(cell),
      columns_(cells_along(extent.x_min, extent.x_max, cell)),
      rows_(cells_along(extent.y_min, extent.y_max, cell)) {
  SF_CHECK(cell > 0.0 && std::isfinite(cell) && std::isfinite(x_min_) && std::isfinite(y_min_),
           "occupancy cells of " + std::to_string(cell) + " m");
  SF_CHECK(static_cast<double>(columns_) * rows_ <= kMaxCells,
           "an occupancy grid of " + std::to_string(columns_) + " x " + std::to_string(rows_) + " cells");
  cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
}

world::Extent ScanHitGrid::extent() const {
  return {x_min_, y_min_, x_min_ + columns_ * cell_, y_min_ + rows_ * cell_};
}

const ScanHitGrid::Cell& ScanHitGrid::at(int column, int row) const {
  SF_CHECK(column >= 0 && row >= 0 && column < columns_ && row < rows_,
           "cell " + std::to_string(column) + ", " + std::to_string(row) + " is outside the grid");
  return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)];
}

CellState ScanHitGrid::state(int column, int row) const {
  const Cell& cell = at(column, row);
  if (cell.hits == 0) return cell.passes == 0 ? CellState::unexplored : CellState::free;
  return cell.hits * kPassesPerHit >= cell.passes ? CellState::occupied : CellState::free;
}

void ScanHitGrid::begin_scan() {
  constexpr std::uint32_t last = 0xFFFFFFF0u;
  if (scan_ >= last) {
    for (Cell& cell : cells_) cell.stamp = 0;
    scan_ = 0;
  }
  scan_ += 2;
}

void ScanHitGrid::count(std::uint16_t& counter, Cell& cell) {
  if (counter == 0xFFFFu) {
    cell.hits /= 2;
    cell.passes /= 2;
  }
  ++counter;
}

void ScanHitGrid::hit(Cell& cell) {
  if (cell.stamp == scan_ + 1) return;
  if (cell.stamp == scan_ && cell.passes > 0) --cell.passes;
  cell.stamp = scan_ + 1;
  count(cell.hits, cell);
}

void ScanHitGrid::pass(Cell& cell) {
  if (cell.stamp >= scan_) return;
  cell.stamp = scan_;
  count(cell.passes, cell);
}

void ScanHitGrid::add_scan(const base::Pose& X_WS, std::span<const double> ranges, double bearing_min,
                           double bearing_increment, double range_max, double range_min,
                           std::span<const std::uint8_t> moving) {
  SF_CHECK(std::isfinite(X_WS.x + X_WS.y + X_WS.yaw) && std::isfinite(range_max), "a scan's pose must be finite");
  SF_CHECK(moving.empty() || moving.size() == ranges.size(), "one mark of movement per range");
  begin_scan();
  const glm::dvec2 from{(X_WS.x - x_min_) / cell_, (X_WS.y - y_min_) / cell_};
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const double range = ranges[k];
    const bool known = range > range_min || (range == 0.0 && range_min == 0.0);
    if (!known) continue;
    const bool met = range < range_max;
    const End end = !met ? End::free : !moving.empty() && moving[k] ? End::skip : End::mark;
    const double bearing = X_WS.yaw + bearing_min + static_cast<double>(k) * bearing_increment;
    const double reach = met ? range / cell_ + kBehindSurface : range_max / cell_;
    add_beam(from, {reach * std::cos(bearing), reach * std::sin(bearing)}, end);
  }
}

void ScanHitGrid::add_beam(glm::dvec2 from, glm::dvec2 along, End end) {
  double t0 = 0.0;
  double t1 = 1.0;
  narrow(from.x, along.x, columns_, t0, t1);
  narrow(from.y, along.y, rows_, t0, t1);
  if (t0 > t1) return;
  const glm::dvec2 a = t0 > 0.0 ? from + t0 * along : from;
  const glm::dvec2 b = t1 < 1.0 ? from + t1 * along : from + along;
  const int i_a = cell_index(a.x, columns_);
  const int j_a = cell_index(a.y, rows_);
  const int i_b = cell_index(b.x, columns_);
  const int j_b = cell_index(b.y, rows_);
  const bool ends_inside = t1 == 1.0 && b.x < columns_ && b.y < rows_;

  // Visits the cells along the beam in order (Amanatides and Woo, "A fast voxel traversal algorithm", 1987). The counts
  // of steps left along x and y keep it inside the box of both end cells, whatever the rounding.
  int left_x = std::abs(i_b - i_a);
  int left_y = std::abs(j_b - j_a);
  const std::ptrdiff_t step_x = i_b >= i_a ? 1 : -1;
  const std::ptrdiff_t step_y = j_b >= j_a ? columns_ : -columns_;
  const double per_x = 1.0 / std::abs(along.x);
  const double per_y = 1.0 / std::abs(along.y);
  double next_x = std::abs(i_b >= i_a ? i_a + 1 - a.x : a.x - i_a) * per_x;
  double next_y = std::abs(j_b >= j_a ? j_a + 1 - a.y : a.y - j_a) * per_y;

  Cell* cell = cells_.data() + static_cast<std::ptrdiff_t>(j_a) * columns_ + i_a;
  steps_ += static_cast<std::uint64_t>(left_x + left_y + 1);
  while (left_x > 0 && left_y > 0) {
    pass(*cell);
    const bool along_x = next_x < next_y;
    cell += along_x ? step_x : step_y;
    next_x += along_x ? per_x : 0.0;
    next_y += along_x ? 0.0 : per_y;
    left_x -= along_x ? 1 : 0;
    left_y -= along_x ? 0 : 1;
  }
  for (; left_x > 0; --left_x, cell += step_x) pass(*cell);
  for (; left_y > 0; --left_y, cell += step_y) pass(*cell);
  if (!ends_inside || end == End::free) return pass(*cell);
  if (end == End::mark) hit(*cell);
}

AreaShares shares(const ScanHitGrid& grid) {
  double count[3] = {0.0, 0.0, 0.0};
  for (int row = 0; row < grid.rows(); ++row)
    for (int column = 0; column < grid.columns(); ++column) ++count[static_cast<std::size_t>(grid.state(column, row))];
  const double all = static_cast<double>(grid.columns()) * grid.rows();
  return {count[0] / all, count[1] / all, count[2] / all};
}

}  // namespace sf::viz
