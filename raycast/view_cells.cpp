#include "raycast/view_cells.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "world/wall_tree.h"

namespace sf::raycast {

ViewCells::ViewCells(const ListConfigs& configs, double (*size)(double range, std::uint32_t beams), CellCache cache)
    : configs_(configs), cache_(std::move(cache)), one_sided_(cache_.slots()) {
  for (std::size_t i = 0; i < configs.size(); ++i) sizes_.push_back(size(configs[i].range, configs[i].beams));
}

void ViewCells::grow(std::uint32_t slots, std::uint32_t chunks) {
  cache_.grow(slots, chunks);
  one_sided_.resize(cache_.slots());
}

/// @param last_slot of the same view in the last tick: a robot mostly stays in its cell
CellKey ViewCells::key_of(const Viewpoint& view, std::uint32_t last_slot) const {
  const double size = sizes_[view.config];
  CellKey key{2 * std::int64_t{view.config}, static_cast<std::int64_t>(std::floor(view.X_WS.x / size)),
              static_cast<std::int64_t>(std::floor(view.X_WS.y / size))};
  // A cell without a surface lies on one side as a whole: the result for its first viewpoint holds for all.
  const auto known = [&] {
    const std::uint32_t slot = cache_.slot_of(key, last_slot);
    return slot != CellCache::kNone && one_sided_[slot] != 0;
  };
  if (known()) return key;
  key.config |= 1;
  if (known() || configs_.wall_index(view.config).inside_solid({view.X_WS.x, view.X_WS.y})) return key;
  key.config &= ~std::int64_t{1};
  return key;
}

void ViewCells::classify_cell(const CellKey& key, std::uint32_t slot, std::span<const std::uint32_t> near) {
  const glm::dvec2 centre = centre_of(key);
  const WallIndex& wall_index = configs_.wall_index(config_of(key));
  const double reach = sizes_[config_of(key)] * M_SQRT1_2 * (1.0 + 1e-9) + 1e-9 * (1.0 + length(centre));
  const bool any = std::any_of(near.begin(), near.end(), [&](std::uint32_t row) {
    const IndexedWall& s = wall_index.segments()[row];
    return s.solid_left && world::distance(centre, s.a, s.b) <= reach;
  });
  one_sided_[slot] = any ? 0 : 1;
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
      const bool same = i > first && views[i].config == views[i - 1].config && views[i].X_WS.x == views[i - 1].X_WS.x &&
                        views[i].X_WS.y == views[i - 1].X_WS.y;
      keys_[i] = same ? keys_[i - 1] : key_of(views[i], slots_[i]);
      slots_[i] = same ? slots_[i - 1] : cache_.slot_of(keys_[i], slots_[i]);
    }
  });
  cache_.begin_tick();
  missing_.clear();
  for (std::size_t i = 0; i < keys_.size(); ++i)
    slots_[i] != CellCache::kNone ? cache_.touch(slots_[i]) : missing_.push_back(keys_[i]);
  const auto order = [](const CellKey& p, const CellKey& q) {
    return std::tie(p.config, p.x, p.y) < std::tie(q.config, q.x, q.y);
  };
  std::sort(missing_.begin(), missing_.end(), order);
  missing_.erase(std::unique(missing_.begin(), missing_.end()), missing_.end());
}

void ViewCells::drop_cached() {
  std::erase_if(missing_, [this](const CellKey& key) { return cache_.find(key) != CellCache::kNone; });
}

}  // namespace sf::raycast
