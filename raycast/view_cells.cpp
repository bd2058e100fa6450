#include "raycast/view_cells.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace sf::raycast {

ViewCells::ViewCells(const Families& families, double (*size)(double range, std::uint32_t beams), CellPool pool)
    : families_(families), pool_(std::move(pool)), uniform_(pool_.slots()) {
  for (std::size_t i = 0; i < families.size(); ++i) sizes_.push_back(size(families[i].range, families[i].beams));
}

void ViewCells::grow(std::uint32_t slots, std::uint32_t chunks) {
  pool_.grow(slots, chunks);
  uniform_.resize(pool_.slots());
}

CellKey ViewCells::key_of(const Viewpoint& view) const {
  const double size = sizes_[view.family];
  CellKey key{2 * std::int64_t{view.family}, static_cast<std::int64_t>(std::floor(view.X_WS.x / size)),
              static_cast<std::int64_t>(std::floor(view.X_WS.y / size))};
  // A cell without a surface is on one side as a whole: that was found out for the first viewpoint in it.
  const auto known = [&] {
    const std::uint32_t slot = pool_.slot_of(key);
    return slot != CellPool::kNone && uniform_[slot] != 0;
  };
  if (known()) return key;
  key.family |= 1;
  if (known() || families_.sight(view.family).inside_solid({view.X_WS.x, view.X_WS.y})) return key;
  key.family &= ~std::int64_t{1};
  return key;
}

void ViewCells::note_sides(const CellKey& key, std::uint32_t slot, const Sight::Nearby& nearby) {
  const glm::dvec2 centre = centre_of(key);
  const Sight& sight = families_.sight(family_of(key));
  const double reach = sizes_[family_of(key)] * M_SQRT1_2 * (1.0 + 1e-9) + 1e-9 * (1.0 + length(centre));
  const bool any = std::any_of(nearby.found.begin(), nearby.found.end(), [&](std::uint32_t row) {
    const SightSegment& s = sight.segments()[row];
    return s.solid_left && world::distance(centre, s.a, s.b) <= reach;
  });
  uniform_[slot] = any ? 0 : 1;
}

glm::dvec2 ViewCells::centre_of(const CellKey& key) const {
  const double size = sizes_[family_of(key)];
  return {(static_cast<double>(key.x) + 0.5) * size, (static_cast<double>(key.y) + 0.5) * size};
}

void ViewCells::find(std::span<const Viewpoint> views, base::ThreadPool& thread_pool) {
  keys_.resize(views.size());
  slots_.resize(views.size());
  thread_pool.parallel_for(views.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const bool same = i > first && views[i].family == views[i - 1].family && views[i].X_WS.x == views[i - 1].X_WS.x &&
                        views[i].X_WS.y == views[i - 1].X_WS.y;
      keys_[i] = same ? keys_[i - 1] : key_of(views[i]);
      slots_[i] = same ? slots_[i - 1] : pool_.slot_of(keys_[i]);
    }
  });
  pool_.begin_tick();
  missing_.clear();
  for (std::size_t i = 0; i < keys_.size(); ++i)
    slots_[i] != CellPool::kNone ? pool_.keep(slots_[i]) : missing_.push_back(keys_[i]);
  const auto order = [](const CellKey& p, const CellKey& q) {
    return std::tie(p.family, p.x, p.y) < std::tie(q.family, q.x, q.y);
  };
  std::sort(missing_.begin(), missing_.end(), order);
  missing_.erase(std::unique(missing_.begin(), missing_.end()), missing_.end());
}

void ViewCells::forget_found() {
  std::erase_if(missing_, [this](const CellKey& key) { return pool_.find(key) != CellPool::kNone; });
}

}  // namespace sf::raycast
