// Lists of movers, made each tick: one for all lasers of a robot that look at one height as far.

#include <algorithm>
#include <atomic>

#include "raycast/scene_parts.h"

namespace sf::raycast {

void Scene::find_groups(std::span<const Viewpoint> views) {
  groups_.clear();
  for (std::size_t i = 0; i < views.size();) {
    Group group{i, i, {views[i].X_WS.x, views[i].X_WS.y}, 0.0, false};
    Vec2 low = group.origin;
    Vec2 high = group.origin;
    for (; i < views.size() && views[i].self == views[group.first].self && views[i].family == views[group.first].family;
         ++i) {
      const Pose& X = views[i].X_WS;
      low = {std::min(low.x, X.x), std::min(low.y, X.y)};
      high = {std::max(high.x, X.x), std::max(high.y, X.y)};
      group.in_solid = group.in_solid || ViewCells::in_solid(cells_.key(i));
    }
    group.end = i;
    if (low.x != high.x || low.y != high.y) {
      group.origin = 0.5 * (low + high);
      group.radius = 0.5 * length(high - low) * (1.0 + 1e-9) + 1e-9;
    }
    groups_.push_back(group);
  }
}

/// @param more_room whether the tables may grow: else what does not fit is left to the host
/// @return false when they should
bool Scene::fill_some_movers(std::span<const Viewpoint> views, bool more_room) {
  if (bodies_->segments().empty()) {
    for (Group& group : groups_) group.alone = true;
    return true;
  }
  std::atomic<std::uint32_t> next{0};
  const ListTables out = tables();
  ListHeader* const headers = headers_->host<ListHeader>().data() + std::size_t{SF_SECTORS} * options_.pool_cells;
  const std::size_t most =
      std::max<std::size_t>(kMostChunksOfAllViews / std::max<std::size_t>(groups_.size(), 1), kLeastChunksOfAView);
  workers_.run(groups_.size(), 16, [&](std::size_t first, std::size_t last, unsigned thread) {
    Scratch& scratch = *scratch_[thread];
    for (std::size_t i = first; i < last; ++i) {
      Group& group = groups_[i];
      const Viewpoint& view = views[group.first];
      const FamilyTables& family = tables_of_[view.family];
      const double fov = group.end - group.first == 1 ? family.fov : 2.0 * M_PI;
      float clearances[SF_SECTORS];
      const bool whole =
          bodies_->collect({group.origin, group.radius, family.height, view.X_WS.yaw, fov, family.range,
                            family.shape.spread, view.self, group.in_solid ? nullptr : family.depth, most * SF_CHUNK},
                           scratch.bodies, scratch.lists, clearances);
      group.for_host = !whole || scratch.lists.longest() > std::min(kMostMoverChunks, most_.longest_list);
      const std::uint32_t chunks = group.for_host ? 0 : scratch.lists.all_chunks();
      group.alone = chunks == 0;
      if (group.alone) continue;
      const std::uint32_t at = next.fetch_add(chunks);
      if (at + chunks > mover_chunks_) {
        group.for_host = group.alone = !more_room;
        continue;
      }
      ListHeader* const own = headers + SF_SECTORS * i;
      write_lists(scratch.lists, options_.pool_chunks + at, out, own);
      for (std::uint32_t s = 0; s < SF_SECTORS; ++s) own[s].clearance = clearances[s];
    }
  });
  mover_chunks_used_ = more_room ? next.load() : std::min(next.load(), mover_chunks_);
  return mover_chunks_used_ <= mover_chunks_;
}

void Scene::name_movers(std::span<const Viewpoint> views, std::span<RayRow> rows) {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const std::size_t set = options_.pool_cells + (groups_[g].alone ? view_capacity_ : g);
    for (std::size_t i = groups_[g].first; i < groups_[g].end; ++i) {
      if (groups_[g].for_host) for_host_[i] = 1;
      rows[i].mover_lists = static_cast<std::uint32_t>(SF_SECTORS * set);
      rows[i].mover_offset_x = static_cast<float>(views[i].X_WS.x - groups_[g].origin.x);
      rows[i].mover_offset_y = static_cast<float>(views[i].X_WS.y - groups_[g].origin.y);
    }
  }
}

}  // namespace sf::raycast
