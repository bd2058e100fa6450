// Lists for the device: walls of new cells, and movers of each tick.

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <tuple>

#include "base/elementary.h"
#include "raycast/device_scene_parts.h"

namespace sf::raycast {

/// Adds one entry per wall of `found`, and assigns it to the sectors in which it may be visible, near to far.
void DeviceScene::Scratch::add(std::vector<CandidateWall>& found, double spread, SectorLists& sectors) {
  std::sort(found.begin(), found.end(), [](const CandidateWall& p, const CandidateWall& q) {
    return std::tie(p.nearest, p.row, p.a.x, p.a.y) < std::tie(q.nearest, q.row, q.a.x, q.a.y);
  });
  sectors.clear();
  for (const CandidateWall& w : found) {
    sectors.add(w.bearing, w.half + spread, static_cast<std::uint32_t>(entries.size()));
    const glm::dvec2 half = 0.5 * (w.b - w.a), middle = w.a + half;
    entries.push_back({static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(half.x),
                       static_cast<float>(half.y)});
    segment_ids.push_back(w.row);
    nearest.push_back(std::nextafter(static_cast<float>(w.nearest), 0.0f));
  }
  sectors.sort();
}

/// Appends chunks of the entries `items`, padded with the entry after the last one. @return number of chunks
std::uint32_t DeviceScene::Scratch::append(std::span<const std::uint32_t> items) {
  for (std::size_t at = 0; at < items.size(); at += SF_CHUNK) {
    ListChunk& chunk = chunks.emplace_back(ListChunk{nearest[items[at]], 0, {}});
    for (std::size_t k = 0; k < SF_CHUNK; ++k)
      chunk.entries[k] = static_cast<std::uint16_t>(at + k < items.size() ? items[at + k] : entries.size());
  }
  return chunks_of(items.size());
}

/// Builds the lists of a cell in `s`, with offsets relative to the cell.
DeviceScene::Cell DeviceScene::make_cell(const CellKey& key, Scratch& s) {
  const std::size_t number = ViewCells::config_of(key);
  const ConfigTables& config = config_tables_[number];
  find_candidate_walls(configs_.wall_index(), config.shape, cells_.centre_of(key), configs_.z_of(key.level),
                       ViewCells::in_solid(key), s.walls);
  s.entries.clear(), s.segment_ids.clear(), s.nearest.clear(), s.chunks.clear();
  s.add(s.walls.front_facing, config.spread, s.front_facing);
  s.add(s.walls.back_facing, config.spread, s.back_facing);
  Cell cell;
  cell.too_long = s.entries.size() >= std::numeric_limits<std::uint16_t>::max();
  for (std::uint32_t k = 0; k < SF_SECTORS && !cell.too_long; ++k) {
    const auto first = static_cast<std::uint32_t>(s.chunks.size());
    const std::uint32_t front_facing = s.append(s.front_facing.of(k)), back_facing = s.append(s.back_facing.of(k));
    s.heads[k] = {first, front_facing, back_facing, 0};
    cell.too_long = front_facing + back_facing > std::min(kMaxWallChunks, limits_.longest_list);
  }
  if (cell.too_long) {
    s.entries.clear(), s.segment_ids.clear(), s.chunks.clear();
    std::fill(std::begin(s.heads), std::end(s.heads), ListHead{});
  }
  s.entries.push_back(kPaddingEntry);
  s.segment_ids.push_back(SF_NO_HIT);
  cell.count = static_cast<std::uint32_t>(SF_SECTORS + s.entries.size() + s.chunks.size());
  return cell;
}

void DeviceScene::build_missing_cells() {
  std::mutex lock;
  ListEntry* const lists = lists_->host<ListEntry>().data();
  std::uint32_t* const segment_ids = segment_ids_->host<std::uint32_t>().data();
  std::atomic<bool> no_room{false};  // the other threads stop; the pool must grow first
  thread_pool_.parallel_for(cells_.missing().size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    Scratch& s = *scratch_[thread];
    for (std::size_t i = first; i < last && !no_room; ++i) {
      const CellKey& key = cells_.missing()[i];
      Cell cell = make_cell(key, s);
      std::uint32_t slot;
      {
        const std::scoped_lock guard(lock);
        slot = cells_.cache().insert(key, (cell.count + kChunkTexels - 1) / kChunkTexels);
        if (slot != CellCache::kNone) new_slots_.push_back(slot);
      }
      if (slot == CellCache::kNone) {
        no_room = true;
        break;
      }
      cell.first = pool_begin_ + kChunkTexels * cells_.cache().first_chunk(slot);
      cell_tables_[slot] = cell;
      cells_.find_clear_parts(key, slot, s.walls.near);
      const std::uint32_t entries = cell.first + SF_SECTORS;
      const auto chunks = entries + static_cast<std::uint32_t>(s.entries.size());
      for (ListHead& head : s.heads) head.first += chunks, head.base = entries;
      std::memcpy(lists + cell.first, s.heads, sizeof s.heads);
      if (!s.entries.empty()) std::memcpy(lists + entries, s.entries.data(), 16 * s.entries.size());
      if (!s.chunks.empty()) std::memcpy(lists + chunks, s.chunks.data(), 16 * s.chunks.size());
      std::copy(s.segment_ids.begin(), s.segment_ids.end(), segment_ids + entries);
    }
  });
  cells_.drop_cached();
}

/// Lists the movers in range and in view, near to far, unless they form a crowd.
void DeviceScene::find_nearby_movers(const Viewpoint& view, Scratch& s) const {
  const MoverGrid& grid = movers_.grid();
  const ListConfig& config = configs_[view.config];
  const auto yaw = static_cast<float>(base::wrap_angle(view.X_WS.yaw));
  const auto most_turned = static_cast<float>(0.5 * config.fov + 1e-5);
  const glm::dvec2 from{view.X_WS.x - grid.low.x, view.X_WS.y - grid.low.y};
  const double reach = config.range * 1.00001 + grid.largest_radius + 2.0 * static_cast<double>(grid.error);
  const auto x = static_cast<float>(from.x), y = static_cast<float>(from.y);
  const auto range = static_cast<float>(config.range * 1.00001);
  const float tolerance =
      grid.error + static_cast<float>(SF_COORDINATE_ERROR * (config.range + 2.0 * grid.largest_radius));
  s.near.clear();
  s.mover_entries.clear();
  s.crowded = false;
  CrowdMeasure around_view, all;
  const int left = grid.column_of(from.x - reach), right = grid.column_of(from.x + reach);
  const std::uint32_t copy = grid.copies.copy_of(view.self);
  for (int row = grid.row_of(from.y - reach, copy); row <= grid.row_of(from.y + reach, copy); ++row)
    for (std::uint32_t at = grid.begin_of(left, row); at < grid.begin_of(right + 1, row); ++at) {
      const float dx = grid.x[at] - x, dy = grid.y[at] - y, radius = 1.0001f * grid.radius[at] + tolerance;
      const float square = dx * dx + dy * dy, most = range + radius;
      if (square > most * most * 1.0001f || grid.skips(at, view.self)) continue;
      ++s.movers_in_range;
      const float distance = std::sqrt(square);
      if (distance < radius && around_view.add(radius, 0.0f)) {
        s.crowded = true;
        return;
      }
      const bool around = radius > 0.8f * distance;
      const float half = around ? 4.0f : 1.0001f * static_cast<float>(base::asin(radius / distance)) + 1e-5f;
      const float bearing = static_cast<float>(base::atan2(dy, dx));
      const float turned = std::abs(bearing - yaw);
      if (std::min(turned, 6.2831853f - turned) > most_turned + half) continue;
      s.near.push_back({std::max(distance - radius, 0.0f) * 0.9999f, radius, grid.mover[at], bearing, half});
    }
  std::sort(s.near.begin(), s.near.end(), [](const NearbyMover& p, const NearbyMover& q) {
    return p.nearest != q.nearest ? p.nearest < q.nearest : p.mover < q.mover;
  });
  s.front_facing.clear();
  for (std::uint32_t k = 0; k < s.near.size(); ++k) {
    NearbyMover& near = s.near[k];
    s.crowded = all.add(near.radius, near.nearest);
    if (s.crowded) return;
    find_front_edges(view, near, s);
    if (near.count == 0) continue;
    ++s.movers_visible;
    const double half = static_cast<double>(near.half) + config_tables_[view.config].spread;
    s.front_facing.add(static_cast<double>(near.bearing), half, k);
  }
  s.front_facing.sort();
}

/// Lists the edges of a mover's outline that face the view; all edges if the view may be inside.
void DeviceScene::find_front_edges(const Viewpoint& view, NearbyMover& near, Scratch& s) const {
  const OutlineTable& outlines = movers_.outlines();
  const Pose& X = movers_.states()[near.mover].X_WM;
  const std::uint32_t slice = outlines.slice_of(near.mover, view.X_WS.z - X.z);
  const OutlineTable::Outline& outline = outlines.slices[outlines.of_mover[near.mover].first + slice].outline;
  near.row = outline.all > 0 ? first_mover_rows_[near.mover] + slice - 1 : 0;
  const glm::dvec2 heading = movers_.headings()[near.mover], p{view.X_WS.x - X.x, view.X_WS.y - X.y};
  const auto x = static_cast<float>(heading.x * p.x + heading.y * p.y);
  const auto y = static_cast<float>(heading.x * p.y - heading.y * p.x);
  const float tolerance = 4.0f * static_cast<float>(SF_COORDINATE_ERROR) *
                          (std::abs(x) + std::abs(y) + 2.0f * static_cast<float>(movers_.largest_radius()));
  near.first = static_cast<std::uint32_t>(s.mover_entries.size());
  const std::uint32_t blocks = near.nearest > 1e-4f ? outline.outward : outline.all;
  near.count = SF_CHUNK * kMaxMoverChunks + 1;  // more than the limit of a list
  if (blocks > kMaxOutlineBlocks) return;
  for (std::uint32_t i = 0; i < blocks; ++i) {
    const SegmentBlock& block = outlines.blocks[outline.first + i];
    float ahead[kBlock];
    for (std::uint32_t k = 0; k < kBlock; ++k)
      ahead[k] = block.ex[k] * (block.ay[k] - y) - block.ey[k] * (block.ax[k] - x) +
                 tolerance * (std::abs(block.ex[k]) + std::abs(block.ey[k]));
    std::uint32_t pending = 0;
    for (std::uint32_t k = 0; k < kBlock; ++k) pending |= static_cast<std::uint32_t>(ahead[k] > 0.0f) << k;
    for (; pending != 0; pending &= pending - 1)
      s.mover_entries.push_back(
          static_cast<std::uint16_t>(kBlockTexels * i + static_cast<std::uint32_t>(std::countr_zero(pending))));
  }
  near.count = static_cast<std::uint32_t>(s.mover_entries.size()) - near.first;
}

/// Writes the lists of the scratch's movers, starting at texel `at`.
void DeviceScene::write_mover_lists(std::uint32_t at, const Scratch& s) {
  std::uint8_t* const lists = lists_->host<std::uint8_t>().data();
  ListHead heads[SF_SECTORS];
  std::uint32_t next = at + SF_SECTORS;
  for (std::uint32_t sector = 0; sector < SF_SECTORS; ++sector) {
    heads[sector] = {next, 0, 0, 0};
    for (const std::uint32_t k : s.front_facing.of(sector)) {
      const NearbyMover& near = s.near[k];
      for (std::uint32_t i = 0; i < near.count; i += SF_CHUNK) {
        ListChunk chunk{near.nearest, near.row + 1, {}};
        for (std::uint32_t e = 0; e < SF_CHUNK; ++e)
          chunk.entries[e] = i + e < near.count ? s.mover_entries[near.first + i + e] : std::uint16_t{kBlock};
        std::memcpy(lists + 16 * std::size_t{next++}, &chunk, sizeof chunk);
      }
    }
    heads[sector].count = next - heads[sector].first;
  }
  std::memcpy(lists + 16 * std::size_t{at}, heads, sizeof heads);
}

/// @return [texels] size of the lists of the scratch's movers; 0: no lists; kNone: a list would exceed the limit
std::uint32_t DeviceScene::mover_lists_size(const Scratch& s, std::size_t most) const {
  std::size_t all = 0;
  for (std::uint32_t sector = 0; sector < SF_SECTORS; ++sector) {
    std::size_t chunks = 0;
    for (const std::uint32_t k : s.front_facing.of(sector)) chunks += chunks_of(s.near[k].count);
    if (chunks > std::min(kMaxMoverChunks, limits_.longest_list)) return CellCache::kNone;
    all += chunks;
  }
  return all == 0 ? 0 : all > most ? CellCache::kNone : static_cast<std::uint32_t>(SF_SECTORS + all);
}

/// @param more_room tables may grow; if false, views without room go to the host
/// @return false if the tables must grow first
bool DeviceScene::build_mover_lists(std::span<const Viewpoint> views, std::span<RayRow> rows, bool more_room) {
  std::atomic<std::uint32_t> next{0};
  const std::size_t most =
      std::max<std::size_t>(kMaxMoverTexels / std::max<std::size_t>(views.size(), 1), kMinMoverTexels);
  thread_pool_.parallel_for(views.size(), 16, [&](std::size_t first, std::size_t last, unsigned thread) {
    Scratch& s = *scratch_[thread];
    for (std::size_t i = first; i < last; ++i) {
      rows[i].movers = 0;  // empty lists
      if (!has_movers()) continue;
      find_nearby_movers(views[i], s);
      const std::uint32_t size = s.crowded ? CellCache::kNone : s.near.empty() ? 0 : mover_lists_size(s, most);
      const std::uint32_t at = size == CellCache::kNone ? 0 : next.fetch_add(size);
      const bool fits = size != CellCache::kNone && at + size <= mover_texels_;
      needs_host_[i] = !fits && (size == CellCache::kNone || !more_room) ? 1 : 0;
      if (size == 0 || !fits) continue;
      rows[i].movers = pool_end() + at;
      write_mover_lists(rows[i].movers, s);
    }
  });
  mover_texels_used_ = more_room ? next.load() : std::min(next.load(), mover_texels_);
  return mover_texels_used_ <= mover_texels_;
}

}  // namespace sf::raycast
