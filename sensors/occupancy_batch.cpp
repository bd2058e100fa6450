#include "sensors/occupancy_batch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "gpu/group_counts.h"
#include "sensors/occupancy_host.h"
#include "sensors/occupancy_tables.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kMostOfAll = 1u << 27;  ///< limit of words in all maps, and of pairs of beams of all their lasers
constexpr float kBearingSlack = 1e-3f;        ///< [rad] many times the error of 32 bits and of the polynomial

BeamLine line_of(std::uint32_t end) {
  const std::int32_t columns = maps::columns_of(end);
  const std::int32_t rows = maps::rows_of(end);
  const bool steep = std::abs(rows) > std::abs(columns);
  const auto along = static_cast<float>(steep ? rows : columns);
  const auto aside = static_cast<float>(steep ? columns : rows);
  if (along == 0.0f) return {0.0f, 0.0f};
  return {aside / along, along + (steep ? std::copysign(static_cast<float>(SF_STEEP_REACH), along) : 0.0f)};
}

/// Returns the device's row of a scan, without the place of its strips.
MapRow row_of(const MapLayout& map, const maps::TracedScan& scan, const base::Pose& X_WS) {
  MapRow row{};
  row.words = map.words;
  row.word_columns = map.settings.grid.word_columns;
  row.pairs = pairs_of(map.settings);
  row.lines = map.lines;
  row.column = static_cast<std::int32_t>(scan.sensor.column);
  row.row = static_cast<std::int32_t>(scan.sensor.row);
  row.within_x = static_cast<float>(scan.within.x);
  row.within_y = static_cast<float>(scan.within.y);
  row.heading = static_cast<float>(base::wrap_angle(X_WS.yaw));
  const double step = map.settings.samples > 1 ? map.settings.fov / (map.settings.samples - 1) : 0.0;
  const bool spread = step > 1e-6;  // false: all parallel beams are tested
  row.half_fov = static_cast<float>(0.5 * map.settings.fov);
  row.per_radian = spread ? static_cast<float>(0.5 / step) : 1.0f;
  row.slack = spread ? kBearingSlack : 1e6f;
  row.round = static_cast<float>(spread ? M_PI / step : 1e7);
  if (map.settings.odds) {
    row.hit = map.settings.odds->hit;
    row.miss = map.settings.odds->miss;
    row.limit = map.settings.odds->limit;
  }
  return row;
}

/// Returns the smallest box of whole words that contains `box`, in cells.
maps::CellBox in_whole_words(const maps::CellBox& box) {
  return {{box.low.column / 4 * 4, box.low.row / 4 * 4}, {(box.high.column + 3) / 4 * 4, (box.high.row + 3) / 4 * 4}};
}

}  // namespace

void MapBatch::Tables::trace() {
  scan_works.resize(scans.size());
  thread_pool.parallel_for(scans.size(), 8, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const MapLayout& map = all[scans[i].map];
      const maps::ScanView view{scans[i].X_WS, scans[i].ranges, *map.beams, map.settings.range_min,
                                map.settings.range_max};
      ScanWork& share = scan_works[i];
      const std::span<std::uint32_t> own = ends_of(map);
      share.scan = maps::trace_scan(map.settings.grid, view, own);
      const auto table = lines->host<BeamLine>().subspan(2 * std::size_t{map.lines}, own.size());
      std::transform(own.begin(), own.end(), table.begin(), line_of);
      share.cells = maps::intersect(share.scan.box, maps::cells_of(map.settings.grid));
      if (!maps::is_empty(share.cells)) share.cells = in_whole_words(share.cells);
    }
  });
}

void MapBatch::Tables::add_strips(std::uint32_t row, const maps::CellBox& cells, bool steep, StripTable& table) {
  const std::int64_t low = steep ? cells.low.row : cells.low.column;
  const std::int64_t high = steep ? cells.high.row : cells.high.column;
  const std::int64_t first_chunk = (steep ? cells.low.column : cells.low.row) / SF_STRIP;
  const std::int64_t end_chunk = units_of(steep ? cells.high.column : cells.high.row, SF_STRIP);
  table.first = static_cast<std::uint32_t>(SF_MAP_BLOCK * strips.count);
  table.pitch = SF_MAP_BLOCK * units_of(high - low, SF_MAP_BLOCK);
  table.low = static_cast<std::uint32_t>(low);
  table.chunk = static_cast<std::uint32_t>(first_chunk);
  const auto blocks = strips.blocks->host<MapBlock>();
  for (std::int64_t chunk = first_chunk; chunk < end_chunk; ++chunk)
    for (std::int64_t at = low; at < high; at += SF_MAP_BLOCK)
      blocks[strips.count++] = {row | (steep ? SF_STEEP : 0u),
                                static_cast<std::uint32_t>(at) | static_cast<std::uint32_t>(chunk) << 16};
}

void MapBatch::Tables::add_words(MapWords& part, std::uint32_t row, ScanWork& share) {
  share.first_block = part.dispatch.count;
  const auto blocks = part.dispatch.blocks->host<MapBlock>();
  for (std::int64_t y = share.cells.low.row / 4; y < share.cells.high.row / 4; ++y)
    for (std::int64_t x = share.cells.low.column / 4; x < share.cells.high.column / 4; x += SF_MAP_BLOCK)
      blocks[part.dispatch.count++] = {row, static_cast<std::uint32_t>(x) | static_cast<std::uint32_t>(y) << 16};
}

void MapBatch::Tables::assign_blocks() {
  strips.count = plain.dispatch.count = log_odds_words.dispatch.count = 0;
  const auto table = rows->host<MapRow>();
  for (std::uint32_t i = 0; i < scans.size(); ++i) {
    const MapLayout& map = all[scans[i].map];
    ScanWork& share = scan_works[i];
    if (maps::is_empty(share.cells)) continue;
    table[i] = row_of(map, share.scan, scans[i].X_WS);
    table[i].box_right = static_cast<std::uint32_t>(share.cells.high.column / 4);
    add_strips(i, share.cells, false, table[i].flat_strips);
    add_strips(i, share.cells, true, table[i].steep_strips);
    add_words(map.settings.odds ? log_odds_words : plain, i, share);
  }
  for (MapDispatch* dispatch : {&strips, &plain.dispatch, &log_odds_words.dispatch})
    if (dispatch->kernel) close(*dispatch);
}

/// Marks the cells in which beams ended.
void MapBatch::Tables::mark_hits() {
  thread_pool.parallel_for(scans.size(), 8, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const ScanWork& share = scan_works[i];
      if (maps::is_empty(share.cells)) continue;
      const MapLayout& map = all[scans[i].map];
      const std::int64_t across =
          SF_MAP_BLOCK * units_of(share.cells.high.column - share.cells.low.column, 4 * SF_MAP_BLOCK);
      const std::int64_t down = (share.cells.high.row - share.cells.low.row) / 4;
      const auto hit_words = (map.settings.odds ? log_odds_words : plain)
                                 .hit_words->host<std::uint32_t>()
                                 .subspan(SF_MAP_BLOCK * share.first_block, static_cast<std::size_t>(across * down));
      std::fill(hit_words.begin(), hit_words.end(), 0u);
      const maps::CellBox& box = share.cells;
      for (const std::uint32_t end : ends_of(map)) {
        const maps::CellAt at{share.scan.sensor.column + maps::columns_of(end),
                              share.scan.sensor.row + maps::rows_of(end)};
        const bool inside = at.column >= box.low.column && at.column < box.high.column && at.row >= box.low.row &&
                            at.row < box.high.row;
        if (!maps::hit_of(end) || !inside) continue;
        const std::int64_t word = (at.row - box.low.row) / 4 * across + (at.column - box.low.column) / 4;
        hit_words[static_cast<std::size_t>(word)] |= 1u << maps::OccupancyGrid::shift_of(at);
      }
    }
  });
}

void MapBatch::Tables::close(MapDispatch& dispatch) {
  const std::size_t group = dispatch.kernel->group_size() / SF_MAP_BLOCK;
  const gpu::GroupCounts groups = gpu::groups_for(dispatch.count, group);
  const auto blocks = dispatch.blocks->host<MapBlock>();
  const std::size_t padded = groups.all() * group;
  const MapBlock nobody{static_cast<std::uint32_t>(all.size()), 0};
  std::fill(blocks.begin() + static_cast<std::ptrdiff_t>(dispatch.count),
            blocks.begin() + static_cast<std::ptrdiff_t>(padded), nobody);
  dispatch.count = padded;
  gpu::write_counts(groups, *dispatch.groups);
}

/// Uploads rows and lines: initially every row, including the one for lanes without work, later only those of this
/// update.
void MapBatch::Tables::send_scans() {
  if (blank) {
    batch.upload(*rows, 0, rows->bytes());
    batch.upload(*lines, 0, lines->bytes());
  } else if (!scans.empty()) {
    constexpr std::size_t kPair = 2 * sizeof(BeamLine);
    const auto [low, high] = std::minmax_element(scans.begin(), scans.end(),
                                                 [](const MapScan& a, const MapScan& b) { return a.map < b.map; });
    const std::size_t first = all[low->map].lines;
    const std::size_t end = all[high->map].lines + pairs_of(all[high->map].settings);
    batch.upload(*rows, 0, scans.size() * sizeof(MapRow));
    batch.upload(*lines, kPair * first, kPair * (end - first));
  }
}

void MapBatch::Tables::send() {
  send_scans();
  for (const MapDispatch* dispatch : {&strips, &plain.dispatch, &log_odds_words.dispatch}) {
    if (!dispatch->kernel) continue;
    batch.upload(*dispatch->blocks, 0, dispatch->count * sizeof(MapBlock));
    batch.upload(*dispatch->groups, 0, dispatch->groups->bytes());
  }
  for (const MapWords* part : {&plain, &log_odds_words})
    if (part->hit_words) batch.upload(*part->hit_words, 0, 4 * SF_MAP_BLOCK * part->dispatch.count);
  if (blank) {
    batch.upload(*words, 0, words->bytes());
    if (odds) batch.upload(*odds, 0, odds->bytes());
    blank = false;
  }
  for (const std::uint32_t map : std::exchange(restarted, {})) {
    const std::size_t first = all[map].words, count = maps::words(all[map].settings.grid);
    batch.upload(*words, 4 * first, 4 * count);
    if (all[map].settings.odds) batch.upload(*odds, 16 * SF_ODDS_TEXELS * first, 16 * SF_ODDS_TEXELS * count);
  }
  for (const std::uint32_t map : wanted)
    batch.download(*words, 4 * std::size_t{all[map].words}, 4 * std::size_t{maps::words(all[map].settings.grid)});
}

void MapBatch::Tables::update(std::span<const MapScan> some, std::span<const std::uint32_t> read) {
  scans.assign(some.begin(), some.end());
  wanted.assign(read.begin(), read.end());
  if (scans.empty() && restarted.empty() && (wanted.empty() || unified)) return;
  trace();
  assign_blocks();
  mark_hits();
  send();
  batch.run();
}

void MapBatch::Tables::restart(std::uint32_t map) {
  const std::size_t first = all[map].words, count = maps::words(all[map].settings.grid);
  const auto clear = [](gpu::Buffer& table, std::size_t begin, std::size_t size) {
    std::ranges::fill(table.host<std::uint32_t>().subspan(begin, size), 0u);
  };
  clear(*words, first, count);
  if (all[map].settings.odds) clear(*odds, 4 * SF_ODDS_TEXELS * first, 4 * SF_ODDS_TEXELS * count);
  restarted.push_back(map);
}

/// The leading maps of both batches have the same places. The new tables are sent to the device with the first update.
void MapBatch::Tables::take_over(Tables& before) {
  if (!before.blank && !unified) {
    gpu::Batch copies(own_device);
    copies.begin();
    copies.end();
    copies.download(*before.words, 0, before.words->bytes());
    if (before.odds) copies.download(*before.odds, 0, before.odds->bytes());
    copies.run();
  }
  const auto copy = [](gpu::Buffer& from, gpu::Buffer& to, std::size_t count) {
    std::copy_n(from.host<std::uint32_t>().begin(), count, to.host<std::uint32_t>().begin());
  };
  copy(*before.words, *words, before.all_words);
  if (before.odds) copy(*before.odds, *odds, 4 * SF_ODDS_TEXELS * before.all_words);
}

MapBatch::MapBatch(gpu::Device& device, base::ThreadPool& thread_pool, std::vector<MapSettings> map_settings,
                   bool on_host)
    : maps_(map_settings.size()) {
  std::size_t words = 0, beams = 0;
  for (const MapSettings& p : map_settings) {
    SF_CHECK(maps::is_valid(p.grid) && p.samples >= 1 && p.samples <= kMostMapBeams,
             std::to_string(p.samples) + " beams on a map of " + std::to_string(p.grid.cell) + " m cells");
    words += maps::words(p.grid);
    beams += pairs_of(p);
    if (words >= kMostOfAll || beams >= kMostOfAll)
      throw base::DeviceError("the maps of all robots have more than " + std::to_string(kMostOfAll) +
                              " words or beams; use fewer robots or smaller maps");
  }
  if (on_host)
    host_ = std::make_unique<HostMaps>(map_settings, thread_pool);
  else
    t_ = std::make_unique<Tables>(device, thread_pool, std::move(map_settings));
}

MapBatch::~MapBatch() = default;

void MapBatch::update(std::span<const MapScan> scans, std::span<const std::uint32_t> wanted) {
  SF_CHECK(scans.size() <= maps_, std::to_string(scans.size()) + " scans for fewer maps");
  if (host_)
    host_->update(scans);
  else
    t_->update(scans, wanted);
}

void MapBatch::restart(std::uint32_t map) { host_ ? host_->restart(map) : t_->restart(map); }

void MapBatch::take_over(MapBatch& before, std::uint32_t maps) {
  if (host_)
    host_->take_over(*before.host_, maps);
  else
    t_->take_over(*before.t_);
}

std::span<const std::uint32_t> MapBatch::words(std::uint32_t map) const {
  if (host_) return host_->words(map);
  return t_->words->host<std::uint32_t>().subspan(t_->all[map].words, maps::words(t_->all[map].settings.grid));
}

}  // namespace sf::sensors
