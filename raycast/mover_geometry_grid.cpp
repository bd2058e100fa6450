// The grid of MoverGeometry: movers by position, without duplicates in crowded cells.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <tuple>

#include "base/box.h"
#include "raycast/mover_geometry.h"

namespace sf::raycast {

namespace {

constexpr std::uint32_t kNoCell = 0xFFFFFFFFu;

/// A pose as words, which are equal only if all bits are equal.
std::array<std::uint64_t, 4> words_of(const Pose& X) {
  return {std::bit_cast<std::uint64_t>(X.x), std::bit_cast<std::uint64_t>(X.y), std::bit_cast<std::uint64_t>(X.z),
          std::bit_cast<std::uint64_t>(X.yaw)};
}

}  // namespace

/// Returns the largest number of cells along each axis, per copy of the world.
std::size_t MoverGeometry::most_cells() const {
  const double each = kMaxGridCells / std::sqrt(grid_.copies.copies());
  return static_cast<std::size_t>(std::max<double>(kMinGridCells, each));
}

void MoverGeometry::build_grid() {
  std::fill(twins_.begin(), twins_.end(), kNoMover);
  find_cells();
  sort_into_cells();
  if (drop_twins()) sort_into_cells();
}

void MoverGeometry::find_cells() {
  base::Box all = base::empty_box();
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (!is_present(i)) continue;
    const Pose& X = states_[i].X_WM;
    all = base::united(all, base::box_of({X.x, X.y}, {X.x, X.y}));
  }
  if (!(all.min.x <= all.max.x)) all = {};
  const auto [low, high] = all;
  const double extent = std::max(high.x - low.x, high.y - low.y);
  grid_.low = low;
  grid_.cell = std::max({4.0 * grid_.largest_radius, extent / static_cast<double>(most_cells() - 1), 1e-6});
  grid_.columns = static_cast<int>((high.x - low.x) / grid_.cell) + 1;
  grid_.rows = static_cast<int>((high.y - low.y) / grid_.cell) + 1;
  // Covers the position of a mover and of a viewer, which may be outside of the grid by up to its range.
  grid_.error = static_cast<float>(0x1p-21 * (extent + grid_.cell));
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const Pose& X = states_[i].X_WM;
    cells_[i] = !is_present(i)
                    ? kNoCell
                    : (grid_.copies.copy_of(static_cast<std::uint32_t>(i)) * static_cast<std::uint32_t>(grid_.rows) +
                       static_cast<std::uint32_t>((X.y - low.y) / grid_.cell)) *
                              static_cast<std::uint32_t>(grid_.columns) +
                          static_cast<std::uint32_t>((X.x - low.x) / grid_.cell);
  }
}

void MoverGeometry::sort_into_cells() {
  grid_.first.assign(
      grid_.copies.copies() * static_cast<std::size_t>(grid_.columns) * static_cast<std::size_t>(grid_.rows) + 1, 0);
  for (const std::uint32_t cell : cells_)
    if (cell != kNoCell) ++grid_.first[cell + 1];
  for (std::size_t i = 1; i < grid_.first.size(); ++i) grid_.first[i] += grid_.first[i - 1];
  next_.assign(grid_.first.begin(), grid_.first.end() - 1);
  for (std::uint32_t i = 0; i < states_.size(); ++i) {
    if (cells_[i] == kNoCell) continue;
    const std::uint32_t at = next_[cells_[i]]++;
    grid_.mover[at] = i;
    grid_.twin[at] = twins_[i];
    grid_.x[at] = static_cast<float>(states_[i].X_WM.x - grid_.low.x);
    grid_.y[at] = static_cast<float>(states_[i].X_WM.y - grid_.low.y);
    grid_.radius[at] = static_cast<float>(radii_[i]);
    grid_.inner[at] = static_cast<float>(inner_[i]);
  }
}

/// In crowded cells, removes all but the first two of coincident movers from the grid. @return true if any were removed
bool MoverGeometry::drop_twins() {
  bool any = false;
  for (std::size_t cell = 0; cell + 1 < grid_.first.size(); ++cell) {
    const std::uint32_t first = grid_.first[cell], count = grid_.first[cell + 1] - first;
    if (count < kCrowd) continue;
    next_.assign(&grid_.mover[first], &grid_.mover[first] + count);
    any = drop_twins(next_) || any;
  }
  return any;
}

bool MoverGeometry::drop_twins(std::span<std::uint32_t> movers) {
  const auto key_of = [this](std::uint32_t m) { return std::tuple(shapes_[m], words_of(states_[m].X_WM), m); };
  const auto coincide = [this](std::uint32_t p, std::uint32_t q) {
    return shapes_[p] == shapes_[q] && words_of(states_[p].X_WM) == words_of(states_[q].X_WM);
  };
  std::sort(movers.begin(), movers.end(), [&](std::uint32_t p, std::uint32_t q) { return key_of(p) < key_of(q); });
  bool any = false;
  for (std::size_t first = 0, end = 0; first < movers.size(); first = end) {
    for (end = first + 1; end < movers.size() && coincide(movers[first], movers[end]); ++end)
      end == first + 1 ? twins_[movers[end]] = movers[first] : cells_[movers[end]] = kNoCell;
    any = any || end > first + 1;
  }
  return any;
}

}  // namespace sf::raycast
