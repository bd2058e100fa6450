// Lists of walls, of the cells that have none yet.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "raycast/scene_parts.h"

namespace sf::raycast {

void Scene::build_missing() {
  std::mutex pool_lock;
  const ListTables out = tables();
  ListHeader* const headers = headers_->host<ListHeader>().data();
  std::atomic<bool> no_room{false};  // the others wait for the pool to grow
  workers_.run(cells_.missing().size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    Scratch& scratch = *scratch_[thread];
    for (std::size_t i = first; i < last && !no_room; ++i) {
      const CellKey& key = cells_.missing()[i];
      const FamilyTables& family = tables_of_[ViewCells::family_of(key)];
      collect(*family.sight, family.shape, cells_.centre_of(key), ViewCells::in_solid(key), scratch.nearby,
              scratch.lists);
      const bool too_long = scratch.lists.longest() > std::min(kMostWallChunks, most_.longest_list);
      if (too_long) {
        scratch.lists.clear();
        scratch.lists.sort();
      }
      std::uint32_t slot;
      {
        const std::scoped_lock guard(pool_lock);
        slot = cells_.pool().insert(key, scratch.lists.all_chunks());
        if (slot != CellPool::kNone) fresh_slots_.push_back(slot);
      }
      if (slot == CellPool::kNone) {
        no_room = true;
        break;
      }
      too_long_[slot] = too_long ? 1 : 0;
      cells_.note_sides(key, slot, scratch.nearby);
      write_lists(scratch.lists, cells_.pool().first_chunk(slot), out, headers + std::size_t{SF_SECTORS} * slot);
    }
  });
  cells_.forget_found();
}

void Scene::fill_walls(const Viewpoint& view, std::size_t row, RayRow& out) {
  const FamilyTables& family = tables_of_[view.family];
  const Vec2 centre = cells_.centre_of(cells_.key(row));
  const double yaw = view.X_WS.yaw;
  const double sectors = std::remainder(yaw, 2.0 * M_PI) * (SF_SECTORS / (2.0 * M_PI));
  out.offset_x = static_cast<float>(view.X_WS.x - centre.x);
  out.offset_y = static_cast<float>(view.X_WS.y - centre.y);
  out.heading_cos64 = std::cos(yaw);
  out.heading_sin64 = std::sin(yaw);
  out.heading_sectors = static_cast<float>(sectors < 0.0 ? sectors + SF_SECTORS : sectors);
  out.band = static_cast<float>(SF_BAND * (family.shape.reach() + 2.0 * bodies_->largest_radius()));
  out.reach = static_cast<float>(family.range * (1.0 + 1e-6) + out.band);
  std::uint32_t slot = cells_.slot(row);
  for_host_[row] = slot == CellPool::kNone || too_long_[slot] != 0 ? 1 : 0;
  if (slot == CellPool::kNone) slot = options_.pool_cells + view_capacity_;  // nobody's
  out.wall_lists = SF_SECTORS * slot;
  out.origin_x = view.X_WS.x;
  out.origin_y = view.X_WS.y;
  out.range_max = family.range;
}

}  // namespace sf::raycast
