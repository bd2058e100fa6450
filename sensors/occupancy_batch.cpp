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

namespace sf::sensors {

namespace {

using gpu::Role;
using gpu::Texel;

constexpr std::uint32_t kGroupsAcross = 32'768;  ///< along x of a dispatch; devices promise 65 535
constexpr float kBearingSlack = 1e-3f;           ///< [rad] many times what 32 bits and a polynomial are wrong by

/// One map as it lies in the tables.
struct Map {
  MapPlan plan;
  std::uint32_t words = 0;                         ///< its first
  std::uint32_t ends = 0;                          ///< its first
  const std::vector<base::Vec2>* beams = nullptr;  ///< lasers with the same fan share them
};

/// The maps of one kernel: with log odds, or without.
struct Course {
  std::unique_ptr<gpu::Kernel> kernel;
  std::unique_ptr<gpu::Buffer> blocks;
  std::unique_ptr<gpu::Buffer> groups;  ///< counts of the dispatch
  std::size_t count = 0;                ///< blocks this time, padding included
};

std::uint32_t blocks_across(std::uint32_t words) { return (words + SF_MAP_BLOCK - 1) / SF_MAP_BLOCK; }

/// What the device needs of a scan.
MapRow row_of(const Map& map, const maps::ScanEnds& scan, const base::Pose& X_WS) {
  MapRow row{};
  row.words = map.words;
  row.word_columns = map.plan.grid.word_columns;
  row.beams = map.plan.samples;
  row.ends = map.ends;
  row.column = static_cast<std::int32_t>(scan.sensor.column);
  row.row = static_cast<std::int32_t>(scan.sensor.row);
  row.within_x = static_cast<float>(scan.within.x);
  row.within_y = static_cast<float>(scan.within.y);
  row.heading_cos = static_cast<float>(std::cos(X_WS.yaw));
  row.heading_sin = static_cast<float>(std::sin(X_WS.yaw));
  const double step = map.plan.samples > 1 ? map.plan.fov / (map.plan.samples - 1) : 0.0;
  const bool spread = step > 1e-6;  // beams that all look one way are all asked
  row.half_fov = static_cast<float>(0.5 * map.plan.fov);
  row.per_radian = spread ? static_cast<float>(1.0 / step) : 1.0f;
  row.slack = spread ? kBearingSlack : 1e6f;
  row.round = static_cast<float>(spread ? 2.0 * M_PI / step : 1e6);
  if (map.plan.odds) {
    row.hit = map.plan.odds->hit;
    row.miss = map.plan.odds->miss;
    row.limit = map.plan.odds->limit;
  }
  return row;
}

}  // namespace

struct MapBatch::Tables {
  base::Workers& workers;
  bool unified;
  std::vector<Map> all;
  std::map<std::pair<double, std::uint32_t>, std::vector<base::Vec2>> fans;
  Course plain;
  Course weighing;
  std::unique_ptr<gpu::Buffer> rows;
  std::unique_ptr<gpu::Buffer> ends;
  std::unique_ptr<gpu::Buffer> words;
  std::unique_ptr<gpu::Buffer> odds;
  std::vector<maps::ScanEnds> traced;  ///< per scan
  gpu::Batch batch;
  bool blank = true;  ///< maps are still to be sent

  Tables(gpu::Device& device, base::Workers& w, std::vector<MapPlan> plans);
  void plan(std::vector<MapPlan> plans);
  void make_course(gpu::Device& device, Course& course, std::span<const std::uint32_t> spirv, bool weighs);
  void bind_and_record();
  void trace(std::span<const MapScan> scans);
  void hand_out(std::span<const MapScan> scans);
  void add_blocks(Course& course, std::uint32_t row, const maps::CellBox& words);
  void close(Course& course);
};

MapBatch::Tables::Tables(gpu::Device& device, base::Workers& w, std::vector<MapPlan> plans)
    : workers(w), unified(device.unified()), batch(device) {
  plan(std::move(plans));
  std::size_t all_words = 0;
  std::size_t all_ends = 0;
  bool weighs = false;
  for (Map& map : all) {
    map.words = static_cast<std::uint32_t>(all_words);
    map.ends = static_cast<std::uint32_t>(all_ends);
    all_words += maps::words(map.plan.grid);
    all_ends += map.plan.samples;
    weighs = weighs || map.plan.odds.has_value();
    SF_CHECK(all_words < (1u << 30) && all_ends < (1u << 30), std::to_string(all_words) + " words of maps");
  }
  rows = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32x4, SF_MAP_ROW_TEXELS * (all.size() + 1));
  ends = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32, all_ends + 1);
  words = std::make_unique<gpu::Buffer>(device, Role::download, Texel::u32, all_words + 1);
  std::fill_n(words->host<std::uint32_t>().data(), all_words + 1, 0u);
  make_course(device, plain, occupancy_comp_spv, false);
  if (weighs) {
    odds = std::make_unique<gpu::Buffer>(device, Role::download, Texel::u32x4, SF_ODDS_TEXELS * (all_words + 1));
    std::fill_n(odds->host<std::uint32_t>().data(), 4 * SF_ODDS_TEXELS * (all_words + 1), 0u);
    make_course(device, weighing, occupancy_odds_comp_spv, true);
  }
  bind_and_record();
}

void MapBatch::Tables::plan(std::vector<MapPlan> plans) {
  for (MapPlan& p : plans) {
    SF_CHECK(maps::is_sound(p.grid) && p.samples >= 1 && p.samples <= kMostMapBeams,
             std::to_string(p.samples) + " beams on a map of " + std::to_string(p.grid.cell) + " m cells");
    auto& fan = fans[{p.fov, p.samples}];
    if (fan.empty()) fan = maps::beam_directions(p.fov, p.samples);
    all.push_back({std::move(p), 0, 0, &fan});
  }
  traced.reserve(all.size());
}

void MapBatch::Tables::make_course(gpu::Device& device, Course& course, std::span<const std::uint32_t> spirv,
                                   bool weighs) {
  course.kernel = std::make_unique<gpu::Kernel>(device, spirv, weighs ? 5 : 4);
  std::size_t most = 0;
  for (const Map& map : all)
    if (map.plan.odds.has_value() == weighs)
      most += std::size_t{blocks_across(map.plan.grid.word_columns)} * map.plan.grid.word_rows;
  // Padded to whole groups, and to whole rows of groups where there are many.
  const std::size_t group = course.kernel->group_size() / SF_MAP_BLOCK;
  const std::size_t groups = most / group + 1;
  const std::size_t padded = (groups > kGroupsAcross ? groups + kGroupsAcross : groups) * group;
  course.blocks = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32, 2 * padded);
  course.groups = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32, 4);
}

void MapBatch::Tables::bind_and_record() {
  gpu::Buffer* tables[] = {rows.get(), plain.blocks.get(), ends.get(), words.get(), odds.get()};
  plain.kernel->bind(std::span(tables).first(4));
  if (weighing.kernel) {
    tables[1] = weighing.blocks.get();
    weighing.kernel->bind(tables);
  }
  batch.begin();
  batch.dispatch(*plain.kernel, *plain.groups, 0);
  if (weighing.kernel) batch.dispatch(*weighing.kernel, *weighing.groups, 0);
  batch.end();
}

void MapBatch::Tables::trace(std::span<const MapScan> scans) {
  traced.resize(scans.size());
  workers.run(scans.size(), 8, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const Map& map = all[scans[i].map];
      const maps::ScanView view{scans[i].X_WS, scans[i].ranges, *map.beams, map.plan.range_min, map.plan.range_max};
      traced[i] =
          maps::trace_ends(map.plan.grid, view, ends->host<std::uint32_t>().subspan(map.ends, map.plan.samples));
    }
  });
}

void MapBatch::Tables::add_blocks(Course& course, std::uint32_t row, const maps::CellBox& box) {
  const auto table = course.blocks->host<MapBlock>();
  for (std::int64_t y = box.low.row; y < box.high.row; ++y)
    for (std::int64_t x = box.low.column; x < box.high.column; x += SF_MAP_BLOCK)
      table[course.count++] = {row, static_cast<std::uint32_t>(x) | static_cast<std::uint32_t>(y) << 16};
}

void MapBatch::Tables::hand_out(std::span<const MapScan> scans) {
  plain.count = weighing.count = 0;
  const auto table = rows->host<MapRow>();
  for (std::uint32_t i = 0; i < scans.size(); ++i) {
    const Map& map = all[scans[i].map];
    const maps::CellBox part = maps::intersect(traced[i].box, maps::cells_of(map.plan.grid));
    if (maps::is_empty(part)) continue;
    table[i] = row_of(map, traced[i], scans[i].X_WS);
    const maps::CellBox in_words{{part.low.column / 4, part.low.row / 4},
                                 {(part.high.column + 3) / 4, (part.high.row + 3) / 4}};
    table[i].box_right = static_cast<std::uint32_t>(in_words.high.column);
    add_blocks(map.plan.odds ? weighing : plain, i, in_words);
  }
  const auto nobody = static_cast<std::uint32_t>(all.size());
  table[nobody] = MapRow{};
  for (Course* course : {&plain, &weighing})
    if (course->kernel) close(*course);
}

void MapBatch::Tables::close(Course& course) {
  const std::size_t group = course.kernel->group_size() / SF_MAP_BLOCK;
  const auto needed = static_cast<std::uint32_t>((course.count + group - 1) / group);
  const std::uint32_t across = std::min(needed, kGroupsAcross);
  const std::uint32_t down = across > 0 ? (needed + across - 1) / across : 0;
  const auto table = course.blocks->host<MapBlock>();
  const std::size_t padded = std::size_t{across} * down * group;
  std::fill(table.begin() + static_cast<std::ptrdiff_t>(course.count),
            table.begin() + static_cast<std::ptrdiff_t>(padded), MapBlock{static_cast<std::uint32_t>(all.size()), 0});
  course.count = padded;
  const auto counts = course.groups->host<std::uint32_t>();
  counts[0] = across;
  counts[1] = down;
  counts[2] = across > 0 ? 1 : 0;
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
  t.batch.up(*t.rows, 0, t.rows->bytes());
  t.batch.up(*t.ends, 0, t.ends->bytes());
  for (const Course* course : {&t.plain, &t.weighing}) {
    if (!course->kernel) continue;
    t.batch.up(*course->blocks, 0, course->count * sizeof(MapBlock));
    t.batch.up(*course->groups, 0, course->groups->bytes());
  }
  if (t.blank) {
    t.batch.up(*t.words, 0, t.words->bytes());
    if (t.odds) t.batch.up(*t.odds, 0, t.odds->bytes());
    t.blank = false;
  }
  for (const std::uint32_t map : wanted)
    t.batch.down(*t.words, 4 * std::size_t{t.all[map].words}, 4 * std::size_t{maps::words(t.all[map].plan.grid)});
  t.batch.run();
}

std::span<const std::uint32_t> MapBatch::words(std::uint32_t map) const {
  return t_->words->host<std::uint32_t>().subspan(t_->all[map].words, maps::words(t_->all[map].plan.grid));
}

}  // namespace sf::sensors
