#include "raycast/device_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "raycast/device_scene_parts.h"

namespace sf::raycast {

namespace {

/// Capacity per robot, which includes cells that it left recently, and a minimum for worlds with few robots.
constexpr SceneOptions kPerRobot{.pool_chunks = 1u << 12, .pool_cells = 1u << 6};
constexpr SceneOptions kMinimum{.pool_chunks = 1u << 15, .pool_cells = 1u << 10};
constexpr std::uint32_t kPageChunks = 8;

/// Returns room for outlines that change, so that most changes keep the tables.
std::size_t with_reserve(std::size_t count) { return count == 0 ? 0 : count + count / 4 + 256; }

/// Returns the first row of each mover, then the end.
std::vector<std::uint32_t> mover_rows_of(const OutlineTable& outlines) {
  std::vector<std::uint32_t> first{0};
  for (const OutlineTable::Shape& shape : outlines.of_mover)
    first.push_back(first.back() + std::max(shape.slices, 2u) - 2);
  return first;
}

/// Returns the side of a cell [m] for kernels that run on the CPU, where short lists save more than small cells cost. A
/// 32nd of the range suits a scanner with several hundred beams; scanners with few beams use larger cells
/// (docs/performance.md).
double fine_cell_size(double range, std::uint32_t beams) {
  const double fewer = std::clamp(std::sqrt(361.0 / std::max(1u, beams)), 1.0, 6.0);
  return std::clamp(fewer * range / 32.0, 1e-3, 4.0);
}

}  // namespace

DeviceScene::DeviceScene(const world::World& world, const ListConfigs& configs, gpu::Device& device,
                         base::ThreadPool& thread_pool, const SceneOptions& options, std::uint32_t sensing_movers)
    : thread_pool_(thread_pool),
      device_(device),
      limits_(options),
      options_{.pool_chunks = 0, .pool_cells = 0},
      configs_(configs),
      movers_(world),
      cells_(configs, device.is_gpu() ? coarse_cell_size : fine_cell_size, CellCache(0, 0, kPageChunks)) {
  for (unsigned i = 0; i < thread_pool.threads(); ++i) scratch_.push_back(std::make_unique<Scratch>());
  for (std::size_t i = 0; i < configs.size(); ++i)
    config_tables_.push_back({{cells_.size_of(i), configs[i].range}, configs[i].spread + 5e-4});
  pool_begin_ += kBlockTexels * static_cast<std::uint32_t>(with_reserve(movers_.outlines().blocks.size()));
  first_mover_rows_ = mover_rows_of(movers_.outlines());
  const std::size_t rows = with_reserve(first_mover_rows_.back());

  const std::vector<world::Segment>& walls = configs.walls();
  const std::size_t count = walls.size() + with_reserve(movers_.segments());
  segments_ = std::make_unique<gpu::Buffer>(device, "walls and movers in 64 bits", gpu::Role::upload, gpu::Texel::u32x4,
                                            gpu::texels_of<ExactSegment>(count + 1));
  models_ = std::make_unique<gpu::Buffer>(device, "whose walls", gpu::Role::upload, gpu::Texel::u32, count + 1);
  mover_rows_ = std::make_unique<gpu::Buffer>(device, "places of movers", gpu::Role::upload, gpu::Texel::u32x4,
                                              gpu::texels_of<MoverRow>(rows + 1));
  const auto exact = segments_->host<ExactSegment>();
  const auto models = models_->host<std::uint32_t>();
  for (std::size_t i = 0; i < walls.size(); ++i) {
    exact[i] = {walls[i].a.x, walls[i].a.y, walls[i].b.x, walls[i].b.y};
    models[i] = walls[i].model;
  }
  make_room(sensing_movers);
  write_outlines();
}

DeviceScene::~DeviceScene() = default;

bool DeviceScene::update_outlines(const world::World& world) {
  MoverGeometry movers(world);
  std::vector<std::uint32_t> rows = mover_rows_of(movers.outlines());
  if (has_movers() != (movers.segments() > 0) ||
      SF_SECTORS + kBlockTexels * movers.outlines().blocks.size() > pool_begin_ ||
      configs_.walls().size() + movers.segments() + 1 > models_->texels() ||
      gpu::texels_of<MoverRow>(rows.back() + 1) > mover_rows_->texels())
    return false;
  movers_ = std::move(movers);
  first_mover_rows_ = std::move(rows);
  write_outlines();
  upload_outlines_ = true;
  return true;
}

void DeviceScene::write_outlines() {
  std::copy(movers_.models().begin(), movers_.models().end(),
            models_->host<std::uint32_t>().begin() + static_cast<std::ptrdiff_t>(configs_.walls().size()));
  const auto entries = lists_->host<ListEntry>();
  const auto segment_ids = segment_ids_->host<std::uint32_t>();
  std::memset(entries.data(), 0, SF_SECTORS * sizeof(ListHead));  // empty lists
  std::uint32_t at = SF_SECTORS;
  for (const SegmentBlock& block : movers_.outlines().blocks) {
    for (std::uint32_t k = 0; k < kBlock; ++k, ++at) {
      const float ex = 0.5f * block.ex[k], ey = 0.5f * block.ey[k];
      entries[at] = {block.ax[k] + ex, block.ay[k] + ey, ex, ey};
      segment_ids[at] = block.row[k];
    }
    entries[at] = kPaddingEntry;
    segment_ids[at++] = SF_NO_HIT;
  }
}

void DeviceScene::place_movers(std::span<const base::Report> states) {
  movers_.place(states, thread_pool_,
                segments_->host<ExactSegment>().subspan(configs_.walls().size(), movers_.segments()));
  const auto mover_rows = mover_rows_->host<MoverRow>();
  const OutlineTable& outlines = movers_.outlines();
  for (std::size_t m = 0; m < states.size(); ++m)
    for (std::uint32_t i = 1; i + 1 < outlines.of_mover[m].slices; ++i)
      mover_rows[first_mover_rows_[m] + i - 1] = {
          states[m].X_WM.x,
          states[m].X_WM.y,
          static_cast<float>(movers_.headings()[m].x),
          static_cast<float>(movers_.headings()[m].y),
          SF_SECTORS + kBlockTexels * outlines.slices[outlines.of_mover[m].first + i].outline.first,
          movers_.first_rows()[m]};
}

bool DeviceScene::prepare(std::span<const Viewpoint> views, std::span<RayRow> rows) {
  tables_replaced_ = false;
  needs_host_.assign(views.size(), 0);
  cells_.find(views, thread_pool_);
  bool room = true;
  for (build_missing_cells(); !cells_.missing().empty() && room && options_.pool_chunks < kMaxPoolChunks;
       build_missing_cells())
    room = try_to_grow(2 * options_.pool_cells + 64, std::min(2 * options_.pool_chunks + 4096, kMaxPoolChunks),
                       mover_texels_);
  room = true;
  while (!build_mover_lists(views, rows, room))
    room = try_to_grow(options_.pool_cells, options_.pool_chunks, 2 * mover_texels_used_);
  thread_pool_.parallel_for(views.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) fill_row(views[i], i, rows[i]);
  });
  return tables_replaced_;
}

void DeviceScene::fill_row(const Viewpoint& view, std::size_t i, RayRow& row) {
  const ConfigTables& config = config_tables_[view.config];
  const glm::dvec2 centre = cells_.centre_of(cells_.key(i));
  const double yaw = view.X_WS.yaw;
  const double sectors = base::wrap_angle(yaw) * (SF_SECTORS / (2.0 * M_PI));
  const std::uint32_t slot = cells_.slot(i);
  row.offset_x = static_cast<float>(view.X_WS.x - centre.x);
  row.offset_y = static_cast<float>(view.X_WS.y - centre.y);
  row.heading_sectors = static_cast<float>(sectors < 0.0 ? sectors + SF_SECTORS : sectors);
  row.band = static_cast<float>(SF_COORDINATE_ERROR * (config.shape.reach() + 2.0 * movers_.largest_radius()));
  if (slot == CellCache::kNone || cell_tables_[slot].too_long) needs_host_[i] = 1;
  row.walls = slot == CellCache::kNone ? 0 : cell_tables_[slot].first;
  row.origin_x = view.X_WS.x;
  row.origin_y = view.X_WS.y;
  row.heading_cos64 = view.heading.x;
  row.heading_sin64 = view.heading.y;
  row.range_max = config.shape.range;
}

DeviceScene::Counts DeviceScene::counts() const {
  Counts counts{cells_.cache().built()};
  for (const auto& scratch : scratch_) {
    counts.movers_in_range += scratch->movers_in_range;
    counts.movers_visible += scratch->movers_visible;
  }
  return counts;
}

void DeviceScene::make_room(std::uint32_t sensing_movers) {
  const auto room = [sensing_movers](std::uint32_t each, std::uint32_t least, std::uint32_t most) {
    return static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(std::uint64_t{each} * sensing_movers, std::min(least, most), most));
  };
  grow(room(kPerRobot.pool_cells, kMinimum.pool_cells, limits_.pool_cells),
       room(kPerRobot.pool_chunks, kMinimum.pool_chunks, limits_.pool_chunks), has_movers() ? 1u << 14 : 1);
}

/// @return false if the device lacks memory
bool DeviceScene::try_to_grow(std::uint32_t pool_cells, std::uint32_t pool_chunks, std::uint32_t mover_texels) {
  try {
    grow(pool_cells, pool_chunks, mover_texels);
    return true;
  } catch (const base::DeviceError&) {
    return false;
  }
}

std::uint32_t DeviceScene::pool_end() const { return pool_begin_ + kChunkTexels * options_.pool_chunks; }

void DeviceScene::grow(std::uint32_t pool_cells, std::uint32_t pool_chunks, std::uint32_t mover_texels) {
  const auto replace = [&](std::unique_ptr<gpu::Buffer>& table, const char* name, gpu::Texel texel,
                           std::size_t texels) {
    if (table && table->texels() == texels) return;
    auto larger = std::make_unique<gpu::Buffer>(device_, name, gpu::Role::upload, texel, texels);
    if (table)
      std::memcpy(larger->host<std::uint8_t>().data(), table->host<std::uint8_t>().data(),
                  std::min(table->bytes(), larger->bytes()));
    table = std::move(larger);
    tables_replaced_ = upload_all_ = true;
  };
  const std::size_t end = pool_begin_ + std::size_t{kChunkTexels} * pool_chunks;
  // The search prefetches one chunk beyond the last.
  replace(lists_, "sector lists", gpu::Texel::u32x4, end + mover_texels + 1);
  replace(segment_ids_, "names in sector lists", gpu::Texel::u32, end);
  cells_.grow(pool_cells, pool_chunks);
  cell_tables_.resize(pool_cells);
  options_ = {.pool_chunks = pool_chunks, .pool_cells = pool_cells};
  mover_texels_ = mover_texels;
}

void DeviceScene::upload(gpu::Batch& batch) {
  const auto lists_up = [&](std::size_t first, std::size_t count) { batch.upload(*lists_, 16 * first, 16 * count); };
  if (upload_all_) {
    lists_up(0, lists_->texels());
    batch.upload(*segment_ids_, 0, segment_ids_->bytes());
    batch.upload(*segments_, 0, segments_->bytes());
    batch.upload(*models_, 0, models_->bytes());
  } else {
    if (upload_outlines_) {
      lists_up(SF_SECTORS, pool_begin_ - SF_SECTORS);
      batch.upload(*segment_ids_, 4 * SF_SECTORS, 4 * (pool_begin_ - SF_SECTORS));
      batch.upload(*models_, 4 * configs_.walls().size(), 4 * movers_.segments());
    }
    // Copies whole pages. Pages of new cells are mostly adjacent, so one copy covers many of them.
    constexpr std::size_t kPageTexels = kPageChunks * kChunkTexels;
    for (const std::uint32_t slot : new_slots_) {
      const std::size_t first = cell_tables_[slot].first;
      const std::size_t count = (cell_tables_[slot].count + kPageTexels - 1) / kPageTexels * kPageTexels;
      lists_up(first, count);
      batch.upload(*segment_ids_, 4 * first, 4 * count);
    }
    lists_up(pool_end(), mover_texels_used_);
    batch.upload(*segments_, configs_.walls().size() * sizeof(ExactSegment), movers_.segments() * sizeof(ExactSegment));
  }
  batch.upload(*mover_rows_, 0, mover_rows_->bytes());
  upload_all_ = upload_outlines_ = false;
  new_slots_.clear();
}

}  // namespace sf::raycast
