#include "sensors/occupancy_batch.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"
#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "sensors/occupancy_records.h"
#include "shaders/occupancy.comp.h"
#include "shaders/occupancy_odds.comp.h"
#include "shaders/occupancy_strips.comp.h"

namespace sf::sensors {

namespace {

using gpu::Role;
using gpu::Texel;

constexpr std::uint32_t kGroupsAcross = 32'768;  ///< along x of a dispatch; devices promise 65 535
constexpr std::size_t kMostOfAll = 1u << 30;     ///< words of all maps; beams of all their lasers
constexpr float kBearingSlack = 1e-3f;           ///< [rad] many times what 32 bits and a polynomial are wrong by

/// One map as it lies in the tables.
struct Map {
  MapPlan plan;
  std::uint32_t words = 0;                         ///< its first
  std::uint32_t lines = 0;                         ///< its first pair of beams
  const std::vector<base::Vec2>* beams = nullptr;  ///< lasers with the same fan share them
};

/// One dispatch: blocks of eight lanes.
struct Course {
  std::unique_ptr<gpu::Kernel> kernel;
  std::unique_ptr<gpu::Buffer> blocks;
  std::unique_ptr<gpu::Buffer> groups;  ///< counts of the dispatch
  std::size_t count = 0;                ///< blocks this time, padding included
};

/// Words of the maps of one kind: with log odds, or without.
struct Words {
  Course course;
  std::unique_ptr<gpu::Buffer> struck;  ///< a word a lane: where beams ended
};

/// What one scan is about.
struct Share {
  maps::ScanEnds scan;
  maps::CellBox cells;          ///< of the map, whole words
  std::size_t first_block = 0;  ///< of its words
};

std::uint32_t whole(std::int64_t cells, std::int64_t unit) {
  return static_cast<std::uint32_t>((cells + unit - 1) / unit);
}

std::uint32_t pairs_of(const MapPlan& plan) { return (plan.samples + 1) / 2; }

BeamLine line_of(std::uint32_t end) {
  const std::int32_t columns = maps::columns_of(end);
  const std::int32_t rows = maps::rows_of(end);
  const bool steep = std::abs(rows) > std::abs(columns);
  const auto along = static_cast<float>(steep ? rows : columns);
  const auto aside = static_cast<float>(steep ? columns : rows);
  if (along == 0.0f) return {0.0f, 0.0f};
  return {aside / along, along + (steep ? std::copysign(static_cast<float>(SF_STEEP_REACH), along) : 0.0f)};
}

/// Blocks that a map's words take, and its strips, when a scan speaks of all of it.
std::size_t word_blocks(const maps::GridPlan& plan) {
  return std::size_t{whole(plan.word_columns, SF_MAP_BLOCK)} * plan.word_rows;
}
std::size_t strip_blocks(const maps::GridPlan& plan) {
  const auto blocks = [](std::int64_t along, std::int64_t across) {
    return std::size_t{whole(along, SF_MAP_BLOCK)} * whole(across, SF_STRIP);
  };
  return blocks(maps::columns(plan), maps::rows(plan)) + blocks(maps::rows(plan), maps::columns(plan));
}

/// What the device needs of a scan, but for where its strips lie.
MapRow row_of(const Map& map, const maps::ScanEnds& scan, const base::Pose& X_WS) {
  MapRow row{};
  row.words = map.words;
  row.word_columns = map.plan.grid.word_columns;
  row.pairs = pairs_of(map.plan);
  row.lines = map.lines;
  row.column = static_cast<std::int32_t>(scan.sensor.column);
  row.row = static_cast<std::int32_t>(scan.sensor.row);
  row.within_x = static_cast<float>(scan.within.x);
  row.within_y = static_cast<float>(scan.within.y);
  row.heading = static_cast<float>(base::wrap_angle(X_WS.yaw));
  const double step = map.plan.samples > 1 ? map.plan.fov / (map.plan.samples - 1) : 0.0;
  const bool spread = step > 1e-6;  // beams that all look one way are all asked
  row.half_fov = static_cast<float>(0.5 * map.plan.fov);
  row.per_radian = spread ? static_cast<float>(0.5 / step) : 1.0f;
  row.slack = spread ? kBearingSlack : 1e6f;
  row.round = static_cast<float>(spread ? M_PI / step : 1e7);
  if (map.plan.odds) {
    row.hit = map.plan.odds->hit;
    row.miss = map.plan.odds->miss;
    row.limit = map.plan.odds->limit;
  }
  return row;
}

/// Whole words that hold `box`, in cells.
maps::CellBox in_whole_words(const maps::CellBox& box) {
  return {{box.low.column / 4 * 4, box.low.row / 4 * 4}, {(box.high.column + 3) / 4 * 4, (box.high.row + 3) / 4 * 4}};
}

}  // namespace

struct MapBatch::Tables {
  base::Workers& workers;
  bool unified;
  std::vector<Map> all;
  std::map<std::pair<double, std::uint32_t>, std::vector<base::Vec2>> fans;
  Course strips;
  Words plain;
  Words weighed;
  std::unique_ptr<gpu::Buffer> rows;
  std::unique_ptr<gpu::Buffer> lines;
  std::vector<std::uint32_t> ends;       ///< of all maps: two for each pair of lines
  std::unique_ptr<gpu::Buffer> covered;  ///< a word a strip
  std::unique_ptr<gpu::Buffer> words;
  std::unique_ptr<gpu::Buffer> odds;
  std::vector<Share> shares;  ///< per scan
  gpu::Batch batch;
  bool blank = true;  ///< maps are still to be sent

  Tables(gpu::Device& device, base::Workers& w, std::vector<MapPlan> plans);
  void plan(std::vector<MapPlan> plans);
  void lay_out();
  std::size_t make_course(gpu::Device& device, Course& course, std::span<const std::uint32_t> spirv,
                          std::uint32_t tables, std::size_t most_blocks);
  void make_words(gpu::Device& device, Words& part, std::span<const std::uint32_t> spirv, bool weighs);
  void record();
  std::span<std::uint32_t> ends_of(const Map& map) {
    return std::span(ends).subspan(2 * std::size_t{map.lines}, map.plan.samples);
  }
  void trace(std::span<const MapScan> scans);
  void hand_out(std::span<const MapScan> scans);
  void add_strips(std::uint32_t row, const maps::CellBox& cells, bool steep, StripTable& table);
  void add_words(Words& part, std::uint32_t row, Share& share);
  void strike(std::span<const MapScan> scans);
  void close(Course& course);
  void send(std::span<const std::uint32_t> wanted);
};

MapBatch::Tables::Tables(gpu::Device& device, base::Workers& w, std::vector<MapPlan> plans)
    : workers(w), unified(device.unified()), batch(device) {
  plan(std::move(plans));
  lay_out();
  const std::size_t all_words = all.empty() ? 0 : all.back().words + maps::words(all.back().plan.grid);
  const std::size_t all_lines = all.empty() ? 0 : all.back().lines + pairs_of(all.back().plan);
  rows = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32x4, SF_MAP_ROW_TEXELS * (all.size() + 1));
  lines = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::f32x4, all_lines + 1);
  ends.resize(2 * all_lines);
  std::fill_n(lines->host<BeamLine>().data(), 2 * (all_lines + 1), BeamLine{});
  words = std::make_unique<gpu::Buffer>(device, Role::download, Texel::u32, all_words + 1);
  std::fill_n(words->host<std::uint32_t>().data(), all_words + 1, 0u);
  std::size_t most = 0;
  for (const Map& map : all) most += strip_blocks(map.plan.grid);
  const std::size_t lanes = make_course(device, strips, occupancy_strips_comp_spv, 4, most);
  covered = std::make_unique<gpu::Buffer>(device, Role::download, Texel::u32, lanes);
  make_words(device, plain, occupancy_comp_spv, false);
  if (std::any_of(all.begin(), all.end(), [](const Map& map) { return map.plan.odds.has_value(); })) {
    odds = std::make_unique<gpu::Buffer>(device, Role::download, Texel::u32x4, SF_ODDS_TEXELS * (all_words + 1));
    std::fill_n(odds->host<std::uint32_t>().data(), 4 * SF_ODDS_TEXELS * (all_words + 1), 0u);
    make_words(device, weighed, occupancy_odds_comp_spv, true);
  }
  record();
}

void MapBatch::Tables::plan(std::vector<MapPlan> plans) {
  for (MapPlan& p : plans) {
    SF_CHECK(maps::is_sound(p.grid) && p.samples >= 1 && p.samples <= kMostMapBeams,
             std::to_string(p.samples) + " beams on a map of " + std::to_string(p.grid.cell) + " m cells");
    auto& fan = fans[{p.fov, p.samples}];
    if (fan.empty()) fan = maps::beam_directions(p.fov, p.samples);
    all.push_back({std::move(p), 0, 0, &fan});
  }
  shares.reserve(all.size());
}

void MapBatch::Tables::lay_out() {
  std::size_t all_words = 0;
  std::size_t all_lines = 0;
  for (Map& map : all) {
    map.words = static_cast<std::uint32_t>(all_words);
    map.lines = static_cast<std::uint32_t>(all_lines);
    all_words += maps::words(map.plan.grid);
    all_lines += pairs_of(map.plan);
    if (all_words >= kMostOfAll || all_lines >= kMostOfAll)
      throw base::DeviceError("the maps of all robots have more than " + std::to_string(kMostOfAll) +
                              " words or beams; use fewer robots or smaller maps");
  }
}

/// @return lanes, whole groups of them.
std::size_t MapBatch::Tables::make_course(gpu::Device& device, Course& course, std::span<const std::uint32_t> spirv,
                                          std::uint32_t tables, std::size_t most_blocks) {
  course.kernel = std::make_unique<gpu::Kernel>(device, spirv, tables);
  // Padded to whole groups, and to whole rows of groups where there are many.
  const std::size_t group = course.kernel->group_size() / SF_MAP_BLOCK;
  const std::size_t groups = most_blocks / group + 1;
  const std::size_t padded = (groups > kGroupsAcross ? groups + kGroupsAcross : groups) * group;
  course.blocks = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32, 2 * padded);
  course.groups = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32, 4);
  return SF_MAP_BLOCK * padded;
}

void MapBatch::Tables::make_words(gpu::Device& device, Words& part, std::span<const std::uint32_t> spirv, bool weighs) {
  std::size_t most = 0;
  for (const Map& map : all)
    if (map.plan.odds.has_value() == weighs) most += word_blocks(map.plan.grid);
  const std::size_t lanes = make_course(device, part.course, spirv, weighs ? 6 : 5, most);
  part.struck = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32, lanes);
}

void MapBatch::Tables::record() {
  gpu::Buffer* const first[] = {rows.get(), strips.blocks.get(), lines.get(), covered.get()};
  strips.kernel->bind(first);
  batch.begin();
  batch.dispatch(*strips.kernel, *strips.groups, 0);
  batch.barrier();
  for (Words* part : {&plain, &weighed}) {
    if (!part->course.kernel) continue;
    gpu::Buffer* const tables[] = {
        rows.get(), part->course.blocks.get(), covered.get(), part->struck.get(), words.get(), odds.get()};
    part->course.kernel->bind(std::span(tables).first(part == &plain ? 5 : 6));
    batch.dispatch(*part->course.kernel, *part->course.groups, 0);
  }
  batch.end();
}

void MapBatch::Tables::trace(std::span<const MapScan> scans) {
  shares.resize(scans.size());
  workers.run(scans.size(), 8, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const Map& map = all[scans[i].map];
      const maps::ScanView view{scans[i].X_WS, scans[i].ranges, *map.beams, map.plan.range_min, map.plan.range_max};
      Share& share = shares[i];
      const std::span<std::uint32_t> own = ends_of(map);
      share.scan = maps::trace_ends(map.plan.grid, view, own);
      const auto table = lines->host<BeamLine>().subspan(2 * std::size_t{map.lines}, own.size());
      std::transform(own.begin(), own.end(), table.begin(), line_of);
      share.cells = maps::intersect(share.scan.box, maps::cells_of(map.plan.grid));
      if (!maps::is_empty(share.cells)) share.cells = in_whole_words(share.cells);
    }
  });
}

void MapBatch::Tables::add_strips(std::uint32_t row, const maps::CellBox& cells, bool steep, StripTable& table) {
  const std::int64_t low = steep ? cells.low.row : cells.low.column;
  const std::int64_t high = steep ? cells.high.row : cells.high.column;
  const std::int64_t first_chunk = (steep ? cells.low.column : cells.low.row) / SF_STRIP;
  const std::int64_t end_chunk = whole(steep ? cells.high.column : cells.high.row, SF_STRIP);
  table.first = static_cast<std::uint32_t>(SF_MAP_BLOCK * strips.count);
  table.pitch = SF_MAP_BLOCK * whole(high - low, SF_MAP_BLOCK);
  table.low = static_cast<std::uint32_t>(low);
  table.chunk = static_cast<std::uint32_t>(first_chunk);
  const auto blocks = strips.blocks->host<MapBlock>();
  for (std::int64_t chunk = first_chunk; chunk < end_chunk; ++chunk)
    for (std::int64_t at = low; at < high; at += SF_MAP_BLOCK)
      blocks[strips.count++] = {row | (steep ? SF_STEEP : 0u),
                                static_cast<std::uint32_t>(at) | static_cast<std::uint32_t>(chunk) << 16};
}

void MapBatch::Tables::add_words(Words& part, std::uint32_t row, Share& share) {
  share.first_block = part.course.count;
  const auto blocks = part.course.blocks->host<MapBlock>();
  for (std::int64_t y = share.cells.low.row / 4; y < share.cells.high.row / 4; ++y)
    for (std::int64_t x = share.cells.low.column / 4; x < share.cells.high.column / 4; x += SF_MAP_BLOCK)
      blocks[part.course.count++] = {row, static_cast<std::uint32_t>(x) | static_cast<std::uint32_t>(y) << 16};
}

void MapBatch::Tables::hand_out(std::span<const MapScan> scans) {
  strips.count = plain.course.count = weighed.course.count = 0;
  const auto table = rows->host<MapRow>();
  for (std::uint32_t i = 0; i < scans.size(); ++i) {
    const Map& map = all[scans[i].map];
    Share& share = shares[i];
    if (maps::is_empty(share.cells)) continue;
    table[i] = row_of(map, share.scan, scans[i].X_WS);
    table[i].box_right = static_cast<std::uint32_t>(share.cells.high.column / 4);
    add_strips(i, share.cells, false, table[i].flat);
    add_strips(i, share.cells, true, table[i].steep);
    add_words(map.plan.odds ? weighed : plain, i, share);
  }
  table[all.size()] = MapRow{};
  for (Course* course : {&strips, &plain.course, &weighed.course})
    if (course->kernel) close(*course);
}

/// Marks the cells that beams ended in.
void MapBatch::Tables::strike(std::span<const MapScan> scans) {
  workers.run(scans.size(), 8, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const Share& share = shares[i];
      if (maps::is_empty(share.cells)) continue;
      const Map& map = all[scans[i].map];
      const std::int64_t across =
          SF_MAP_BLOCK * whole(share.cells.high.column - share.cells.low.column, 4 * SF_MAP_BLOCK);
      const std::int64_t down = (share.cells.high.row - share.cells.low.row) / 4;
      const auto struck = (map.plan.odds ? weighed : plain)
                              .struck->host<std::uint32_t>()
                              .subspan(SF_MAP_BLOCK * share.first_block, static_cast<std::size_t>(across * down));
      std::fill(struck.begin(), struck.end(), 0u);
      const maps::CellBox& box = share.cells;
      for (const std::uint32_t end : ends_of(map)) {
        const maps::CellAt at{share.scan.sensor.column + maps::columns_of(end),
                              share.scan.sensor.row + maps::rows_of(end)};
        const bool inside = at.column >= box.low.column && at.column < box.high.column && at.row >= box.low.row &&
                            at.row < box.high.row;
        if (!maps::hit_of(end) || !inside) continue;
        const std::int64_t word = (at.row - box.low.row) / 4 * across + (at.column - box.low.column) / 4;
        struck[static_cast<std::size_t>(word)] |= 1u << maps::Grid::shift_of(at);
      }
    }
  });
}

void MapBatch::Tables::close(Course& course) {
  const std::size_t group = course.kernel->group_size() / SF_MAP_BLOCK;
  const auto needed = static_cast<std::uint32_t>((course.count + group - 1) / group);
  const std::uint32_t across = std::min(needed, kGroupsAcross);
  const std::uint32_t down = across > 0 ? (needed + across - 1) / across : 0;
  const auto blocks = course.blocks->host<MapBlock>();
  const std::size_t padded = std::size_t{across} * down * group;
  const MapBlock nobody{static_cast<std::uint32_t>(all.size()), 0};
  std::fill(blocks.begin() + static_cast<std::ptrdiff_t>(course.count),
            blocks.begin() + static_cast<std::ptrdiff_t>(padded), nobody);
  course.count = padded;
  const auto counts = course.groups->host<std::uint32_t>();
  counts[0] = across;
  counts[1] = down;
  counts[2] = across > 0 ? 1 : 0;
}

void MapBatch::Tables::send(std::span<const std::uint32_t> wanted) {
  batch.up(*rows, 0, rows->bytes());
  batch.up(*lines, 0, lines->bytes());
  for (const Course* course : {&strips, &plain.course, &weighed.course}) {
    if (!course->kernel) continue;
    batch.up(*course->blocks, 0, course->count * sizeof(MapBlock));
    batch.up(*course->groups, 0, course->groups->bytes());
  }
  for (const Words* part : {&plain, &weighed})
    if (part->struck) batch.up(*part->struck, 0, 4 * SF_MAP_BLOCK * part->course.count);
  if (blank) {
    batch.up(*words, 0, words->bytes());
    if (odds) batch.up(*odds, 0, odds->bytes());
    blank = false;
  }
  for (const std::uint32_t map : wanted)
    batch.down(*words, 4 * std::size_t{all[map].words}, 4 * std::size_t{maps::words(all[map].plan.grid)});
}

MapBatch::MapBatch(gpu::Device& device, base::Workers& workers, std::vector<MapPlan> plans)
    : t_(std::make_unique<Tables>(device, workers, std::move(plans))) {}

MapBatch::~MapBatch() = default;

void MapBatch::update(std::span<const MapScan> scans, std::span<const std::uint32_t> wanted) {
  Tables& t = *t_;
  if (scans.empty() && (wanted.empty() || t.unified)) return;
  SF_CHECK(scans.size() <= t.all.size(), std::to_string(scans.size()) + " scans for fewer maps");
  t.trace(scans);
  t.hand_out(scans);
  t.strike(scans);
  t.send(wanted);
  t.batch.run();
}

std::span<const std::uint32_t> MapBatch::words(std::uint32_t map) const {
  return t_->words->host<std::uint32_t>().subspan(t_->all[map].words, maps::words(t_->all[map].plan.grid));
}

}  // namespace sf::sensors
