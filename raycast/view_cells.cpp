#include "raycast/view_cells.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "world/wall_tree.h"

namespace sf::raycast {

namespace {

constexpr int kSide = 8;  ///< number of parts along each side of a cell
constexpr std::uint64_t kFirstColumn = 0x0101010101010101u, kAll = ~std::uint64_t{0};

/// Returns all parts in `clear` that are connected with those in `from`.
std::uint64_t connected(std::uint64_t from, std::uint64_t clear) {
  for (std::uint64_t all = from & clear;; from = all) {
    all |= ((all << 1) & ~kFirstColumn) | ((all & ~kFirstColumn) >> 1) | all << kSide | all >> kSide;
    all &= clear;
    if (all == from) return all;
  }
}

}  // namespace

double coarse_cell_size(double range, std::uint32_t beams) {
  const double fewer = std::clamp(std::sqrt(361.0 / std::max(1u, beams)), 1.0, 4.0);
  return std::clamp(fewer * range / 8.0, std::clamp(range, 1e-3, 0.25), 4.0);
}

ViewCells::ViewCells(const ListConfigs& configs, double (*size)(double range, std::uint32_t beams), CellCache cache)
    : configs_(configs), cache_(std::move(cache)), parts_(cache_.slots()) {
  for (std::size_t i = 0; i < configs.size(); ++i) sizes_.push_back(size(configs[i].range, configs[i].beams));
}

void ViewCells::grow(std::uint32_t slots, std::uint32_t chunks) {
  cache_.grow(slots, chunks);
  parts_.resize(cache_.slots());
}

/// @param last_slot slot of the same view in the last tick; robots mostly stay in their cells
CellKey ViewCells::key_of(const Viewpoint& view, std::uint32_t last_slot) const {
  const double size = sizes_[view.config];
  CellKey key{2 * std::int64_t{view.config}, static_cast<std::int64_t>(std::floor(view.X_WS.x / size)),
              static_cast<std::int64_t>(std::floor(view.X_WS.y / size)), configs_.level_of(view.X_WS.z)};
  // A region that no surface divides is on one side as a whole, so the result for one viewpoint applies to all of them.
  const std::uint32_t part = part_of(view);
  const auto known = [&] {
    const std::uint32_t slot = cache_.slot_of(key, last_slot);
    return slot != CellCache::kNone && (parts_[slot].known >> part & 1) != 0;
  };
  if (known()) return key;
  key.config |= 1;
  if (known() || configs_.wall_index().inside_solid({view.X_WS.x, view.X_WS.y}, view.X_WS.z)) return key;
  key.config &= ~std::int64_t{1};
  return key;
}

std::uint32_t ViewCells::part_of(const Viewpoint& view) const {
  const double size = sizes_[view.config];
  const auto along = [size](double at) {
    const double part = kSide * (at / size - std::floor(at / size));
    return std::min(static_cast<std::uint32_t>(part), kSide - 1u);
  };
  return kSide * along(view.X_WS.y) + along(view.X_WS.x);
}

void ViewCells::find_clear_parts(const CellKey& key, std::uint32_t slot, std::span<const std::uint32_t> near) {
  const WallIndex& wall_index = configs_.wall_index();
  const double size = sizes_[config_of(key)], part = size / kSide;
  const glm::dvec2 centre = centre_of(key), first = centre - 0.5 * (size - part) * glm::dvec2{1.0, 1.0};
  const double rounding = 1e-9 * (1.0 + length(centre));
  const auto touches = [&](const IndexedWall& s, glm::dvec2 middle, double side) {
    return world::distance(middle, s.a, s.b) <= side * M_SQRT1_2 * (1.0 + 1e-9) + rounding;
  };
  std::uint64_t clear = kAll;
  for (const std::uint32_t row : near) {
    const IndexedWall& s = wall_index.segments()[row];
    if (!s.solid_left || !touches(s, centre, size)) continue;
    for (int i = 0; i < kSide * kSide; ++i)
      if (touches(s, first + part * glm::dvec2{i % kSide, i / kSide}, part)) clear &= ~(std::uint64_t{1} << i);
  }
  parts_[slot] = {clear, 0};
}

/// Marks the parts that are connected with the part of this viewpoint as being on the cell's side.
void ViewCells::learn_side(const Viewpoint& view, Parts& parts) const {
  if (parts.known == parts.clear) return;
  const std::uint64_t own = std::uint64_t{1} << part_of(view);
  if ((own & parts.clear & ~parts.known) != 0) parts.known |= connected(own, parts.clear);
}

glm::dvec2 ViewCells::centre_of(const CellKey& key) const {
  const double size = sizes_[config_of(key)];
  return {(static_cast<double>(key.x) + 0.5) * size, (static_cast<double>(key.y) + 0.5) * size};
}

void ViewCells::find(std::span<const Viewpoint> views, base::ThreadPool& thread_pool) {
  keys_.resize(views.size());
  slots_.resize(views.size(), CellCache::kNone);
  thread_pool.parallel_for(views.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const bool same = i > first && views[i].config == views[i - 1].config && views[i].X_WS.z == views[i - 1].X_WS.z &&
                        views[i].X_WS.x == views[i - 1].X_WS.x && views[i].X_WS.y == views[i - 1].X_WS.y;
      keys_[i] = same ? keys_[i - 1] : key_of(views[i], slots_[i]);
      slots_[i] = same ? slots_[i - 1] : cache_.slot_of(keys_[i], slots_[i]);
    }
  });
  cache_.begin_tick();
  missing_.clear();
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (slots_[i] == CellCache::kNone) {
      missing_.push_back(keys_[i]);
      continue;
    }
    cache_.touch(slots_[i]);
    learn_side(views[i], parts_[slots_[i]]);
  }
  const auto order = [](const CellKey& p, const CellKey& q) {
    return std::tie(p.config, p.level, p.x, p.y) < std::tie(q.config, q.level, q.x, q.y);
  };
  std::sort(missing_.begin(), missing_.end(), order);
  missing_.erase(std::unique(missing_.begin(), missing_.end()), missing_.end());
}

void ViewCells::drop_cached() {
  std::erase_if(missing_, [this](const CellKey& key) { return cache_.find(key) != CellCache::kNone; });
}

}  // namespace sf::raycast
