#include "raycast/scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "raycast/scene_parts.h"

namespace sf::raycast {

namespace {

/// Robots drive on: of the cells that each of them left lately, so many are kept, and of few robots more.
constexpr SceneOptions kEach{.pool_chunks = 1u << 12, .pool_cells = 1u << 6};
constexpr SceneOptions kLeast{.pool_chunks = 1u << 15, .pool_cells = 1u << 10};
constexpr std::uint32_t kPageChunks = 8;

/// Lists for small cells are short, but each cell costs: a 32nd of the range suits a scanner of some hundred beams, few
/// beams are not worth so many (docs/performance.md).
double cell_size(double range, std::uint32_t beams) {
  const double fewer = std::clamp(std::sqrt(361.0 / std::max(1u, beams)), 1.0, 6.0);
  return std::clamp(fewer * range / 32.0, 1e-3, 4.0);
}

}  // namespace

Scene::Scene(const world::World& world, const Families& families, gpu::Device& device, base::ThreadPool& thread_pool,
             const SceneOptions& options, std::uint32_t carriers)
    : thread_pool_(thread_pool),
      device_(device),
      most_(options),
      options_{.pool_chunks = 0, .pool_cells = 0},
      families_(families),
      movers_(world),
      cells_(families, cell_size, CellPool(0, 0, kPageChunks)) {
  for (unsigned i = 0; i < thread_pool.threads(); ++i) scratch_.push_back(std::make_unique<Scratch>());
  for (std::size_t i = 0; i < families.size(); ++i)
    tables_of_.push_back(
        {{cells_.size_of(i), families[i].range}, families[i].spread + 5e-4, movers_.watch_height(families[i].z)});
  for (std::uint32_t h = 0; h < movers_.heights(); ++h) {
    outlines_.push_back(pool_begin_);
    pool_begin_ += kBlockTexels * static_cast<std::uint32_t>(movers_.outlines(h).blocks.size());
  }

  const std::vector<world::Segment>& walls = families.walls();
  const std::size_t count = walls.size() + movers_.segments();
  segments_ = std::make_unique<gpu::Buffer>(device, "walls and movers in 64 bits", gpu::Role::upload, gpu::Texel::u32x4,
                                            2 * count + 2);
  models_ = std::make_unique<gpu::Buffer>(device, "whose walls", gpu::Role::upload, gpu::Texel::u32, count + 1);
  places_ = std::make_unique<gpu::Buffer>(device, "places of movers", gpu::Role::upload, gpu::Texel::u32x4,
                                          2 * movers_.heights() * world.movers.size() + 2);
  const auto exact = segments_->host<ExactSegment>();
  const auto models = models_->host<std::uint32_t>();
  for (std::size_t i = 0; i < walls.size(); ++i) {
    exact[i] = {walls[i].a.x, walls[i].a.y, walls[i].b.x, walls[i].b.y};
    models[i] = walls[i].model;
  }
  std::copy(movers_.models().begin(), movers_.models().end(),
            models.begin() + static_cast<std::ptrdiff_t>(walls.size()));
  make_room(carriers);
  write_outlines();
}

Scene::~Scene() = default;

void Scene::write_outlines() {
  const auto entries = lists_->host<ListEntry>();
  const auto names = names_->host<std::uint32_t>();
  std::memset(entries.data(), 0, SF_SECTORS * sizeof(ListHead));  // lists of nobody
  for (std::uint32_t h = 0; h < movers_.heights(); ++h) {
    std::uint32_t at = outlines_[h];
    for (const SegmentBlock& block : movers_.outlines(h).blocks) {
      for (std::uint32_t k = 0; k < kBlock; ++k, ++at) {
        const float ex = 0.5f * block.ex[k], ey = 0.5f * block.ey[k];
        entries[at] = {block.ax[k] + ex, block.ay[k] + ey, ex, ey};
        names[at] = block.row[k];
      }
      entries[at] = kFacesNobody;
      names[at++] = SF_NO_HIT;
    }
  }
}

void Scene::place(std::span<const Pose> poses) {
  movers_.place(poses, thread_pool_,
                segments_->host<ExactSegment>().subspan(families_.walls().size(), movers_.segments()));
  const auto places = places_->host<MoverPlace>();
  for (std::uint32_t h = 0; h < movers_.heights(); ++h)
    for (std::size_t m = 0; m < poses.size(); ++m)
      places[h * poses.size() + m] = {poses[m].x,
                                      poses[m].y,
                                      static_cast<float>(movers_.headings()[m].x),
                                      static_cast<float>(movers_.headings()[m].y),
                                      outlines_[h] + kBlockTexels * movers_.outlines(h).of_mover[m].first,
                                      movers_.first_rows()[m]};
}

bool Scene::serve(std::span<const Viewpoint> views, std::span<RayRow> rows) {
  replaced_ = false;
  for_host_.assign(views.size(), 0);
  cells_.find(views, thread_pool_);
  bool room = true;
  for (build_missing(); !cells_.missing().empty() && room && options_.pool_chunks < kMostPoolChunks; build_missing())
    room = try_to_grow(2 * options_.pool_cells + 64, std::min(2 * options_.pool_chunks + 4096, kMostPoolChunks),
                       near_texels_);
  room = true;
  while (!list_movers(views, rows, room)) room = try_to_grow(options_.pool_cells, options_.pool_chunks, 2 * near_used_);
  thread_pool_.parallel_for(views.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) fill_row(views[i], i, rows[i]);
  });
  return replaced_;
}

void Scene::fill_row(const Viewpoint& view, std::size_t i, RayRow& row) {
  const FamilyTables& family = tables_of_[view.family];
  const glm::dvec2 centre = cells_.centre_of(cells_.key(i));
  const double yaw = view.X_WS.yaw;
  const double sectors = base::wrap_angle(yaw) * (SF_SECTORS / (2.0 * M_PI));
  const std::uint32_t slot = cells_.slot(i);
  row.offset_x = static_cast<float>(view.X_WS.x - centre.x);
  row.offset_y = static_cast<float>(view.X_WS.y - centre.y);
  row.heading_sectors = static_cast<float>(sectors < 0.0 ? sectors + SF_SECTORS : sectors);
  row.band = static_cast<float>(SF_BAND * (family.shape.reach() + 2.0 * movers_.largest_radius()));
  if (slot == CellPool::kNone || cell_tables_[slot].too_long) for_host_[i] = 1;
  row.walls = slot == CellPool::kNone ? 0 : cell_tables_[slot].first;
  row.origin_x = view.X_WS.x;
  row.origin_y = view.X_WS.y;
  row.heading_cos64 = view.heading.x;
  row.heading_sin64 = view.heading.y;
  row.range_max = family.shape.range;
}

Scene::Counts Scene::counts() const {
  Counts counts{cells_.pool().built()};
  for (const auto& scratch : scratch_) {
    counts.movers_near += scratch->movers_near;
    counts.movers_met += scratch->movers_met;
  }
  return counts;
}

void Scene::make_room(std::uint32_t carriers) {
  const auto room = [carriers](std::uint32_t each, std::uint32_t least, std::uint32_t most) {
    return static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(std::uint64_t{each} * carriers, std::min(least, most), most));
  };
  grow(room(kEach.pool_cells, kLeast.pool_cells, most_.pool_cells),
       room(kEach.pool_chunks, kLeast.pool_chunks, most_.pool_chunks), has_movers() ? 1u << 14 : 1);
}

/// @return false when the device has no room for more
bool Scene::try_to_grow(std::uint32_t pool_cells, std::uint32_t pool_chunks, std::uint32_t near_texels) {
  try {
    grow(pool_cells, pool_chunks, near_texels);
    return true;
  } catch (const base::DeviceError&) {
    return false;
  }
}

std::uint32_t Scene::pool_end() const { return pool_begin_ + kChunkTexels * options_.pool_chunks; }

void Scene::grow(std::uint32_t pool_cells, std::uint32_t pool_chunks, std::uint32_t near_texels) {
  const auto replace = [&](std::unique_ptr<gpu::Buffer>& table, const char* name, gpu::Texel texel,
                           std::size_t texels) {
    if (table && table->texels() == texels) return;
    auto larger = std::make_unique<gpu::Buffer>(device_, name, gpu::Role::upload, texel, texels);
    if (table)
      std::memcpy(larger->host<std::uint8_t>().data(), table->host<std::uint8_t>().data(),
                  std::min(table->bytes(), larger->bytes()));
    table = std::move(larger);
    replaced_ = upload_all_ = true;
  };
  const std::size_t end = pool_begin_ + std::size_t{kChunkTexels} * pool_chunks;
  // A search looks one chunk ahead.
  replace(lists_, "sector lists", gpu::Texel::u32x4, end + near_texels + 1);
  replace(names_, "names in sector lists", gpu::Texel::u32, end);
  cells_.grow(pool_cells, pool_chunks);
  cell_tables_.resize(pool_cells);
  options_ = {.pool_chunks = pool_chunks, .pool_cells = pool_cells};
  near_texels_ = near_texels;
}

void Scene::upload(gpu::Batch& batch) {
  const auto lists_up = [&](std::size_t first, std::size_t count) { batch.upload(*lists_, 16 * first, 16 * count); };
  if (upload_all_) {
    lists_up(0, lists_->texels());
    batch.upload(*names_, 0, names_->bytes());
    batch.upload(*segments_, 0, segments_->bytes());
    batch.upload(*models_, 0, models_->bytes());
  } else {
    for (const std::uint32_t slot : fresh_slots_) {
      const Cell& cell = cell_tables_[slot];
      lists_up(cell.first, cell.count);
      batch.upload(*names_, 4 * std::size_t{cell.first}, 4 * std::size_t{cell.count});
    }
    lists_up(pool_end(), near_used_);
    batch.upload(*segments_, families_.walls().size() * sizeof(ExactSegment),
                 movers_.segments() * sizeof(ExactSegment));
  }
  batch.upload(*places_, 0, places_->bytes());
  upload_all_ = false;
  fresh_slots_.clear();
}

}  // namespace sf::raycast
