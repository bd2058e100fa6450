// The device's lists: of walls, where a cell has none yet, and of movers, each tick.

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <tuple>

#include "raycast/scene_parts.h"

namespace sf::raycast {

/// Takes in `found`: an entry each, and the sectors in which it may be seen, near to far.
void Scene::Scratch::add(std::vector<FoundWall>& found, double spread, SectorLists& sectors) {
  std::sort(found.begin(), found.end(), [](const FoundWall& p, const FoundWall& q) {
    return std::tie(p.nearest, p.row, p.a.x, p.a.y) < std::tie(q.nearest, q.row, q.a.x, q.a.y);
  });
  sectors.clear();
  for (const FoundWall& w : found) {
    sectors.add(w.bearing, w.half + spread, static_cast<std::uint32_t>(entries.size()));
    const glm::dvec2 half = 0.5 * (w.b - w.a), middle = w.a + half;
    entries.push_back({static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(half.x),
                       static_cast<float>(half.y)});
    names.push_back(w.row);
    nearest.push_back(std::nextafter(static_cast<float>(w.nearest), 0.0f));
  }
  sectors.sort();
}

/// Appends chunks of entries `items`, padded with the one behind all. @return how many
std::uint32_t Scene::Scratch::append(std::span<const std::uint32_t> items) {
  for (std::size_t at = 0; at < items.size(); at += SF_CHUNK) {
    ListChunk& chunk = chunks.emplace_back(ListChunk{nearest[items[at]], 0, {}});
    for (std::size_t k = 0; k < SF_CHUNK; ++k)
      chunk.entries[k] = static_cast<std::uint16_t>(at + k < items.size() ? items[at + k] : entries.size());
  }
  return chunks_of(items.size());
}

/// Makes the lists of a cell in `s`, but for where they lie.
Scene::Cell Scene::make_cell(const CellKey& key, Scratch& s) {
  const std::size_t number = ViewCells::family_of(key);
  const FamilyTables& family = tables_of_[number];
  find_walls(families_.sight(number), family.shape, cells_.centre_of(key), ViewCells::in_solid(key), s.walls);
  s.entries.clear(), s.names.clear(), s.nearest.clear(), s.chunks.clear();
  s.add(s.walls.facing, family.spread, s.facing);
  s.add(s.walls.behind, family.spread, s.behind);
  Cell cell;
  cell.too_long = s.entries.size() >= std::numeric_limits<std::uint16_t>::max();
  for (std::uint32_t k = 0; k < SF_SECTORS && !cell.too_long; ++k) {
    const auto first = static_cast<std::uint32_t>(s.chunks.size());
    const std::uint32_t facing = s.append(s.facing.of(k)), behind = s.append(s.behind.of(k));
    s.heads[k] = {first, facing, behind, 0};
    cell.too_long = facing + behind > std::min(kMostWallChunks, most_.longest_list);
  }
  if (cell.too_long) {
    s.entries.clear(), s.names.clear(), s.chunks.clear();
    std::fill(std::begin(s.heads), std::end(s.heads), ListHead{});
  }
  s.entries.push_back(kFacesNobody);
  s.names.push_back(SF_NO_HIT);
  cell.count = static_cast<std::uint32_t>(SF_SECTORS + s.entries.size() + s.chunks.size());
  return cell;
}

void Scene::build_missing() {
  std::mutex lock;
  ListEntry* const lists = lists_->host<ListEntry>().data();
  std::uint32_t* const names = names_->host<std::uint32_t>().data();
  std::atomic<bool> no_room{false};  // the others wait for the pool to grow
  thread_pool_.parallel_for(cells_.missing().size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    Scratch& s = *scratch_[thread];
    for (std::size_t i = first; i < last && !no_room; ++i) {
      const CellKey& key = cells_.missing()[i];
      Cell cell = make_cell(key, s);
      std::uint32_t slot;
      {
        const std::scoped_lock guard(lock);
        slot = cells_.pool().insert(key, (cell.count + kChunkTexels - 1) / kChunkTexels);
        if (slot != CellPool::kNone) fresh_slots_.push_back(slot);
      }
      if (slot == CellPool::kNone) {
        no_room = true;
        break;
      }
      cell.first = pool_begin_ + kChunkTexels * cells_.pool().first_chunk(slot);
      cell_tables_[slot] = cell;
      cells_.note_sides(key, slot, s.walls.nearby);
      const std::uint32_t entries = cell.first + SF_SECTORS;
      const auto chunks = entries + static_cast<std::uint32_t>(s.entries.size());
      for (ListHead& head : s.heads) head.first += chunks, head.base = entries;
      std::memcpy(lists + cell.first, s.heads, sizeof s.heads);
      if (!s.entries.empty()) std::memcpy(lists + entries, s.entries.data(), 16 * s.entries.size());
      if (!s.chunks.empty()) std::memcpy(lists + chunks, s.chunks.data(), 16 * s.chunks.size());
      std::copy(s.names.begin(), s.names.end(), names + entries);
    }
  });
  cells_.forget_found();
}

/// Lists the movers in reach and in view, near to far.
void Scene::find_near(const Viewpoint& view, Scratch& s) const {
  const MoverGrid& grid = movers_.grid();
  const Family& family = families_[view.family];
  const auto yaw = static_cast<float>(base::wrap_angle(view.X_WS.yaw));
  const auto most_turned = static_cast<float>(0.5 * family.fov + 1e-5);
  const glm::dvec2 from{view.X_WS.x - grid.low.x, view.X_WS.y - grid.low.y};
  const double reach = family.range * 1.00001 + grid.largest_radius + 2.0 * static_cast<double>(grid.error);
  const auto x = static_cast<float>(from.x), y = static_cast<float>(from.y);
  const auto range = static_cast<float>(family.range * 1.00001);
  const float slip = grid.error + static_cast<float>(SF_BAND * (family.range + 2.0 * grid.largest_radius));
  s.near.clear();
  s.near_entries.clear();
  const int left = grid.column_of(from.x - reach), right = grid.column_of(from.x + reach);
  for (int row = grid.row_of(from.y - reach); row <= grid.row_of(from.y + reach); ++row)
    for (std::uint32_t at = grid.begin_of(left, row); at < grid.begin_of(right + 1, row); ++at) {
      const float dx = grid.x[at] - x, dy = grid.y[at] - y, radius = 1.0001f * grid.radius[at] + slip;
      const float square = dx * dx + dy * dy, most = range + radius;
      if (square > most * most * 1.0001f || grid.mover[at] == view.self) continue;
      ++s.movers_near;
      const float distance = std::sqrt(square);
      const bool around = radius > 0.8f * distance;
      const float half = around ? 4.0f : 1.0001f * std::asin(radius / distance) + 1e-5f;
      const float bearing = std::atan2(dy, dx);
      const float turned = std::abs(bearing - yaw);
      if (std::min(turned, 6.2831853f - turned) > most_turned + half) continue;
      s.near.push_back({std::max(distance - radius, 0.0f) * 0.9999f, grid.mover[at], bearing, half});
    }
  std::sort(s.near.begin(), s.near.end(), [](const Near& p, const Near& q) {
    return p.nearest != q.nearest ? p.nearest < q.nearest : p.mover < q.mover;
  });
  s.facing.clear();
  for (std::uint32_t k = 0; k < s.near.size(); ++k) {
    Near& near = s.near[k];
    find_facing(view, near, s);
    if (near.count == 0) continue;
    ++s.movers_met;
    const double half = static_cast<double>(near.half) + tables_of_[view.family].spread;
    s.facing.add(static_cast<double>(near.bearing), half, k);
  }
  s.facing.sort();
}

/// Lists the edges of a mover's outline that face the view, all of them where it may stand inside.
void Scene::find_facing(const Viewpoint& view, Near& near, Scratch& s) const {
  const std::uint32_t height = tables_of_[view.family].height;
  const OutlineTable& outlines = movers_.outlines(height);
  const OutlineTable::Outline& outline = outlines.of_mover[near.mover];
  const Pose& X = movers_.poses()[near.mover];
  const glm::dvec2 heading = movers_.headings()[near.mover], p{view.X_WS.x - X.x, view.X_WS.y - X.y};
  const auto x = static_cast<float>(heading.x * p.x + heading.y * p.y);
  const auto y = static_cast<float>(heading.x * p.y - heading.y * p.x);
  const float slip = 4.0f * static_cast<float>(SF_BAND) *
                     (std::abs(x) + std::abs(y) + 2.0f * static_cast<float>(movers_.largest_radius()));
  near.first = static_cast<std::uint32_t>(s.near_entries.size());
  const std::uint32_t blocks = near.nearest > 1e-4f ? outline.outward : outline.all;
  near.count = SF_CHUNK * kMostMoverChunks + 1;  // more than a list holds
  if (blocks > kMostOutlineBlocks) return;
  for (std::uint32_t i = 0; i < blocks; ++i) {
    const SegmentBlock& block = outlines.blocks[outline.first + i];
    float ahead[kBlock];
    for (std::uint32_t k = 0; k < kBlock; ++k)
      ahead[k] = block.ex[k] * (block.ay[k] - y) - block.ey[k] * (block.ax[k] - x) +
                 slip * (std::abs(block.ex[k]) + std::abs(block.ey[k]));
    std::uint32_t open = 0;
    for (std::uint32_t k = 0; k < kBlock; ++k) open |= static_cast<std::uint32_t>(ahead[k] > 0.0f) << k;
    for (; open != 0; open &= open - 1)
      s.near_entries.push_back(
          static_cast<std::uint16_t>(kBlockTexels * i + static_cast<std::uint32_t>(std::countr_zero(open))));
  }
  near.count = static_cast<std::uint32_t>(s.near_entries.size()) - near.first;
}

/// Writes the lists of the scratch's movers for one view, from texel `at` on.
void Scene::write_near(const Viewpoint& view, std::uint32_t at, const Scratch& s) {
  const auto first_place = static_cast<std::uint32_t>(tables_of_[view.family].height * movers_.poses().size()) + 1;
  std::uint8_t* const lists = lists_->host<std::uint8_t>().data();
  ListHead heads[SF_SECTORS];
  std::uint32_t next = at + SF_SECTORS;
  for (std::uint32_t sector = 0; sector < SF_SECTORS; ++sector) {
    heads[sector] = {next, 0, 0, 0};
    for (const std::uint32_t k : s.facing.of(sector)) {
      const Near& near = s.near[k];
      for (std::uint32_t i = 0; i < near.count; i += SF_CHUNK) {
        ListChunk chunk{near.nearest, first_place + near.mover, {}};
        for (std::uint32_t e = 0; e < SF_CHUNK; ++e)
          chunk.entries[e] = i + e < near.count ? s.near_entries[near.first + i + e] : std::uint16_t{kBlock};
        std::memcpy(lists + 16 * std::size_t{next++}, &chunk, sizeof chunk);
      }
    }
    heads[sector].count = next - heads[sector].first;
  }
  std::memcpy(lists + 16 * std::size_t{at}, heads, sizeof heads);
}

/// @return [texels] that the lists of the scratch's movers need; 0: none does; kNone: they would be too long
std::uint32_t Scene::size_of_near(const Scratch& s, std::size_t most) const {
  std::size_t all = 0;
  for (std::uint32_t sector = 0; sector < SF_SECTORS; ++sector) {
    std::size_t chunks = 0;
    for (const std::uint32_t k : s.facing.of(sector)) chunks += chunks_of(s.near[k].count);
    if (chunks > std::min(kMostMoverChunks, most_.longest_list)) return CellPool::kNone;
    all += chunks;
  }
  return all == 0 ? 0 : all > most ? CellPool::kNone : static_cast<std::uint32_t>(SF_SECTORS + all);
}

/// @param more_room whether the tables may grow: else what does not fit is left to the host
/// @return false when they should
bool Scene::list_movers(std::span<const Viewpoint> views, std::span<RayRow> rows, bool more_room) {
  std::atomic<std::uint32_t> next{0};
  const std::size_t most =
      std::max<std::size_t>(kMostNearTexels / std::max<std::size_t>(views.size(), 1), kLeastNearTexels);
  thread_pool_.parallel_for(views.size(), 16, [&](std::size_t first, std::size_t last, unsigned thread) {
    Scratch& s = *scratch_[thread];
    for (std::size_t i = first; i < last; ++i) {
      rows[i].movers = 0;  // of nobody
      if (!has_movers()) continue;
      find_near(views[i], s);
      const std::uint32_t size = s.near.empty() ? 0 : size_of_near(s, most);
      const std::uint32_t at = size == CellPool::kNone ? 0 : next.fetch_add(size);
      const bool fits = size != CellPool::kNone && at + size <= near_texels_;
      for_host_[i] = !fits && (size == CellPool::kNone || !more_room) ? 1 : 0;
      if (size == 0 || !fits) continue;
      rows[i].movers = pool_end() + at;
      write_near(views[i], rows[i].movers, s);
    }
  });
  near_used_ = more_room ? next.load() : std::min(next.load(), near_texels_);
  return near_used_ <= near_texels_;
}

}  // namespace sf::raycast
