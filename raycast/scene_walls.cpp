// Lists of walls: which cell each sensor stands in, and the cells that have no lists yet.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <tuple>

#include "raycast/scene_parts.h"

namespace sf::raycast {

CellKey Scene::key_of(const Viewpoint& view) const {
  const FamilyTables& family = *families_[view.family];
  CellKey key{2 * std::int64_t{view.family}, static_cast<std::int64_t>(std::floor(view.X_WS.x / family.shape.size)),
              static_cast<std::int64_t>(std::floor(view.X_WS.y / family.shape.size))};
  // A cell without a surface is on one side as a whole: whoever stood in it before has found out.
  const auto known = [&] {
    const std::uint32_t slot = pool_.slot_of(key);
    return slot != CellPool::kNone && uniform_[slot] != 0;
  };
  if (known()) return key;
  key.family |= 1;
  if (known() || family.sight->inside_solid({view.X_WS.x, view.X_WS.y})) return key;
  key.family &= ~std::int64_t{1};
  return key;
}

bool Scene::is_uniform(const FamilyTables& family, Vec2 centre, const Sight::Nearby& nearby) const {
  const double reach = family.shape.size * M_SQRT1_2 * (1.0 + 1e-9) + 1e-9 * (1.0 + length(centre));
  return std::none_of(nearby.found.begin(), nearby.found.end(), [&](std::uint32_t row) {
    const SightSegment& s = family.sight->segments()[row];
    return s.solid_left && world::distance(centre, s.a, s.b) <= reach;
  });
}

Vec2 Scene::centre_of(const FamilyTables& family, const CellKey& key) const {
  return {(static_cast<double>(key.x) + 0.5) * family.shape.size,
          (static_cast<double>(key.y) + 0.5) * family.shape.size};
}

void Scene::find_cells(std::span<const Viewpoint> views) {
  keys_.resize(views.size());
  slots_.resize(views.size());
  workers_.run(views.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
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

void Scene::build_missing() {
  std::mutex pool_lock;
  const ListTables out = tables();
  ListHeader* const headers = headers_->host<ListHeader>().data();
  std::atomic<bool> no_room{false};  // whoever comes later waits for the pool to grow
  workers_.run(missing_.size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    Scratch& scratch = *scratch_[thread];
    for (std::size_t i = first; i < last && !no_room; ++i) {
      const CellKey& key = missing_[i];
      const FamilyTables& family = *families_[static_cast<std::size_t>(key.family / 2)];
      collect(*family.sight, family.shape, centre_of(family, key), key.family % 2 == 1, scratch.nearby, scratch.lists);
      const bool too_long = scratch.lists.longest() > std::min(kMostWallChunks, most_.longest_list);
      if (too_long) {
        scratch.lists.clear();
        scratch.lists.sort();
      }
      std::uint32_t slot;
      {
        const std::scoped_lock guard(pool_lock);
        slot = pool_.insert(key, scratch.lists.all_chunks());
        if (slot != CellPool::kNone) fresh_slots_.push_back(slot);
      }
      if (slot == CellPool::kNone) {
        no_room = true;
        break;
      }
      too_long_[slot] = too_long ? 1 : 0;
      uniform_[slot] = is_uniform(family, centre_of(family, key), scratch.nearby) ? 1 : 0;
      write_lists(scratch.lists, pool_.first_chunk(slot), out, headers + std::size_t{SF_SECTORS} * slot);
    }
  });
  forget_found();
}

void Scene::forget_found() {
  std::erase_if(missing_, [this](const CellKey& key) { return pool_.find(key) != CellPool::kNone; });
}

void Scene::fill_walls(const Viewpoint& view, std::size_t row, RayRow& out) {
  const FamilyTables& family = *families_[view.family];
  const Vec2 centre = centre_of(family, keys_[row]);
  const double yaw = view.X_WS.yaw;
  const double sectors = std::remainder(yaw, 2.0 * M_PI) * (SF_SECTORS / (2.0 * M_PI));
  out.offset_x = static_cast<float>(view.X_WS.x - centre.x);
  out.offset_y = static_cast<float>(view.X_WS.y - centre.y);
  out.heading_cos64 = std::cos(yaw);
  out.heading_sin64 = std::sin(yaw);
  out.heading_sectors = static_cast<float>(sectors < 0.0 ? sectors + SF_SECTORS : sectors);
  out.band = static_cast<float>(SF_BAND * (family.shape.reach() + 2.0 * bodies_->largest_radius()));
  out.reach = static_cast<float>(family.family.range * (1.0 + 1e-6) + out.band);
  std::uint32_t slot = slots_[row] != CellPool::kNone ? slots_[row] : pool_.slot_of(keys_[row]);
  for_host_[row] = slot == CellPool::kNone || too_long_[slot] != 0 ? 1 : 0;
  if (slot == CellPool::kNone) slot = options_.pool_cells + view_capacity_;  // nobody's
  out.wall_lists = SF_SECTORS * slot;
  out.origin_x = view.X_WS.x;
  out.origin_y = view.X_WS.y;
  out.range_max = family.family.range;
}

}  // namespace sf::raycast
