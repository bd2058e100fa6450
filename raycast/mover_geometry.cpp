#include "raycast/mover_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/box.h"

namespace sf::raycast {

namespace {

constexpr int kMaxCells = 256;  ///< along an axis
constexpr std::uint32_t kNoCell = 0xFFFFFFFFu;

}  // namespace

MoverGeometry::MoverGeometry(const world::World& world) : walls_(static_cast<std::uint32_t>(world.walls.size())) {
  for (const world::Mover& mover : world.movers) {
    first_rows_.push_back(walls_ + static_cast<std::uint32_t>(local_.size()));
    for (const world::Segment& s : mover.body) {
      if (!s.seen_by_laser) continue;
      local_.push_back(s);
      models_.push_back(s.model);
    }
    const bool met = first_rows_.back() - walls_ < local_.size();
    radii_.push_back(met ? mover.radius : 0.0);
    load_z_.push_back(mover.X_WM.z);
    grid_.largest_radius = std::max(grid_.largest_radius, mover.radius);
  }
  first_rows_.push_back(walls_ + static_cast<std::uint32_t>(local_.size()));
  const std::size_t movers = world.movers.size(), padded = movers + kBlock;
  headings_.resize(movers);
  cells_.resize(movers);
  grid_.mover.resize(padded);
  grid_.x.resize(padded), grid_.y.resize(padded), grid_.radius.resize(padded);
  grid_.first.reserve(std::size_t{kMaxCells} * kMaxCells + 1);
  next_.reserve(grid_.first.capacity());
}

std::uint32_t MoverGeometry::add_height(double z) {
  for (std::uint32_t i = 0; i < heights_.size(); ++i)
    if (heights_[i].z == z) return i;
  heights_.push_back({z, outlines_at(z)});
  return static_cast<std::uint32_t>(heights_.size() - 1);
}

/// Movers of equal shape share blocks.
OutlineTable MoverGeometry::outlines_at(double z) const {
  OutlineTable table;
  std::map<std::vector<double>, OutlineTable::Outline> known;
  for (std::size_t m = 0; m + 1 < first_rows_.size(); ++m) {
    std::vector<double> shape;
    std::vector<SegmentBlock> outward, inward;
    std::uint32_t used_outward = 0, used_inward = 0;
    for (std::uint32_t row = first_rows_[m]; row < first_rows_[m + 1]; ++row) {
      const world::Segment& s = local_[row - walls_];
      if (z - load_z_[m] < s.z_min || z - load_z_[m] >= s.z_max) continue;
      const std::uint32_t number = row - first_rows_[m];
      append(outward, used_outward, s.a, s.b, number);
      s.solid_left ? append(inward, used_inward, s.b, s.a, number) : append(outward, used_outward, s.b, s.a, number);
      shape.insert(shape.end(), {s.a.x, s.a.y, s.b.x, s.b.y, static_cast<double>(number), s.solid_left ? 1.0 : 0.0});
    }
    const auto [found, fresh] = known.try_emplace(std::move(shape));
    if (fresh) {
      const auto first = static_cast<std::uint32_t>(table.blocks.size());
      table.blocks.insert(table.blocks.end(), outward.begin(), outward.end());
      table.blocks.insert(table.blocks.end(), inward.begin(), inward.end());
      found->second = {first, static_cast<std::uint32_t>(outward.size()),
                       static_cast<std::uint32_t>(outward.size() + inward.size())};
    }
    table.of_mover.push_back(found->second);
  }
  return table;
}

void MoverGeometry::place(std::span<const base::Report> states, base::ThreadPool& thread_pool,
                          std::span<ExactSegment> exact) {
  states_ = states;
  thread_pool.parallel_for(states_.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const Pose& X = states_[i].X_WM;
      headings_[i] = {std::cos(X.yaw), std::sin(X.yaw)};
      for (std::uint32_t row = first_rows_[i] - walls_; row < first_rows_[i + 1] - walls_; ++row) {
        exact[row] = to_world(local_[row].a, local_[row].b, {X.x, X.y}, headings_[i]);
      }
    }
  });
  build_grid();
}

void MoverGeometry::build_grid() {
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
  grid_.cell = std::max({4.0 * grid_.largest_radius, extent / (kMaxCells - 1), 1e-6});
  grid_.columns = static_cast<int>((high.x - low.x) / grid_.cell) + 1;
  grid_.rows = static_cast<int>((high.y - low.y) / grid_.cell) + 1;
  // Covers the position of a mover, and of a viewer, which may lie outside the grid by its range.
  grid_.error = static_cast<float>(0x1p-21 * (extent + grid_.cell));
  grid_.first.assign(static_cast<std::size_t>(grid_.columns) * static_cast<std::size_t>(grid_.rows) + 1, 0);
  for (std::size_t i = 0; i < states_.size(); ++i) {
    cells_[i] = kNoCell;
    if (!is_present(i)) continue;
    const Pose& X = states_[i].X_WM;
    cells_[i] = static_cast<std::uint32_t>((X.y - low.y) / grid_.cell) * static_cast<std::uint32_t>(grid_.columns) +
                static_cast<std::uint32_t>((X.x - low.x) / grid_.cell);
    ++grid_.first[cells_[i] + 1];
  }
  for (std::size_t i = 1; i < grid_.first.size(); ++i) grid_.first[i] += grid_.first[i - 1];
  next_.assign(grid_.first.begin(), grid_.first.end() - 1);
  for (std::uint32_t i = 0; i < states_.size(); ++i) {
    if (cells_[i] == kNoCell) continue;
    const std::uint32_t at = next_[cells_[i]]++;
    grid_.mover[at] = i;
    grid_.x[at] = static_cast<float>(states_[i].X_WM.x - low.x);
    grid_.y[at] = static_cast<float>(states_[i].X_WM.y - low.y);
    grid_.radius[at] = static_cast<float>(radii_[i]);
  }
}

}  // namespace sf::raycast
