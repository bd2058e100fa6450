#include "sensors/scene/scene.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <mutex>

#include "base/error.h"
#include "sensors/scene/clearance.h"

namespace sf::sensors {

namespace {

/// Loops of one lane together stay below the 65 535 turns after which older Mesa ends them silently: a search visits
/// each chunk once, a decision each entry once for each of a lane's beams.
constexpr std::uint32_t kMostWallChunks = 2'800;  ///< per sector
constexpr std::uint32_t kMostMoverChunks = 1'000;
static_assert((kMostWallChunks + kMostMoverChunks) * (1 + SF_BEAMS_PER_LANE * SF_CHUNK) + 16 < 65'535);
constexpr double kClearanceCap = 0.05;  ///< [m]

/// Lists for small cells are short, but each cell costs: a 32nd of the range suits a scanner of some hundred beams, few
/// beams are not worth so many (docs/performance.md).
double cell_size(double range, std::uint32_t beams) {
  const double fewer = std::clamp(std::sqrt(361.0 / std::max(1u, beams)), 1.0, 6.0);
  return std::clamp(fewer * range / 32.0, 1e-3, 4.0);
}

std::vector<double> height_breaks(const std::vector<world::Segment>& walls) {
  std::vector<double> breaks;
  for (const world::Segment& s : walls) {
    breaks.push_back(s.z_min);
    breaks.push_back(s.z_max);
  }
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  return breaks;
}

std::unique_ptr<Sight> flat_sight(const std::vector<world::Segment>& walls) {
  world::World flat;
  for (world::Segment s : walls) {
    s.z_min = 0.0;
    s.z_max = 1.0;
    flat.walls.push_back(s);
  }
  return std::make_unique<Sight>(flat, 0.5, 2.0);
}

void refuse_if_too_long(std::uint32_t chunks, std::uint32_t most, const char* what) {
  if (chunks <= most) return;
  throw base::InputError("more than " + std::to_string(most * SF_CHUNK) + " segments of " + what +
                         " lie within range of one sensor in one direction; lower range_max or simplify the world");
}

}  // namespace

struct Scene::FamilyTables {
  Family family;
  CellShape shape;
  const Sight* sight = nullptr;
  const Depth* depth = nullptr;
  std::uint32_t height = 0;
};

struct Scene::Scratch {
  Sight::Nearby nearby;
  SectorLists lists;
  Bodies::Scratch bodies;
};

Scene::Scene(const world::World& world, gpu::Device& device, base::Workers& workers, const SceneOptions& options)
    : workers_(workers),
      device_(device),
      options_(options),
      walls_(world.walls),
      breaks_(height_breaks(walls_)),
      all_walls_(flat_sight(walls_)),
      pool_(options.pool_cells, options.pool_chunks) {
  bodies_ = std::make_unique<Bodies>(world, all_walls_.get());
  for (unsigned i = 0; i < workers.threads(); ++i) scratch_.push_back(std::make_unique<Scratch>());

  // Exact segments: walls now, movers each tick.
  const std::size_t count = walls_.size() + bodies_->segments().size();
  segments_ = std::make_unique<gpu::Buffer>(device, gpu::Role::upload, gpu::Texel::u32x4, 2 * count + 2);
  models_ = std::make_unique<gpu::Buffer>(device, gpu::Role::upload, gpu::Texel::u32, count + 1);
  if (count >= SF_ROW_MASK)
    throw base::InputError("the world has " + std::to_string(count) + " segments; at most " +
                           std::to_string(SF_ROW_MASK - 1) + " are supported");
  const auto exact = segments_->host<ExactSegment>();
  const auto models = models_->host<std::uint32_t>();
  std::vector<float> clearances = wall_clearances(walls_, kClearanceCap);
  const std::vector<float> own = bodies_->own_clearances(kClearanceCap);
  clearances.insert(clearances.end(), own.begin(), own.end());
  for (std::size_t i = 0; i < walls_.size(); ++i)
    exact[i] = {walls_[i].a.x, walls_[i].a.y, walls_[i].b.x, walls_[i].b.y};
  for (std::uint32_t i = 0; i < count; ++i) {
    models[i] = i < walls_.size() ? walls_[i].model : bodies_->models()[i - walls_.size()];
    words_.push_back(list_word(i, clearances[i]));
  }

  grow(options.pool_cells, options.pool_chunks, 64, 4096);
}

Scene::~Scene() = default;

std::uint32_t Scene::add_family(const Family& family) {
  const auto interval =
      static_cast<std::size_t>(std::upper_bound(breaks_.begin(), breaks_.end(), family.z) - breaks_.begin());
  auto& sight = sights_[interval];
  if (!sight) {
    world::World view;
    view.walls = walls_;
    sight = std::make_unique<Sight>(view, family.z, family.range);
  }
  for (std::uint32_t i = 0; i < families_.size(); ++i) {
    FamilyTables& known = *families_[i];
    if (known.sight != sight.get() || known.family.range != family.range || known.family.z != family.z) continue;
    known.shape.spread = std::max(known.shape.spread, family.spread + 5e-4);
    known.family.fov = std::max(known.family.fov, family.fov);
    return i;
  }
  auto tables = std::make_unique<FamilyTables>();
  tables->family = family;
  tables->shape = {cell_size(family.range, family.beams), family.range, family.spread + 5e-4};
  tables->sight = sight.get();
  // Only movers are looked up in it.
  auto& depth = depths_[interval];
  if (!depth && bodies_->count() > 1) depth = std::make_unique<Depth>(*sight, workers_);
  tables->depth = depth.get();
  tables->height = bodies_->watch_height(family.z);
  families_.push_back(std::move(tables));
  return static_cast<std::uint32_t>(families_.size() - 1);
}

void Scene::place(std::span<const Pose> poses) {
  bodies_->place(poses, workers_);
  const auto moved = bodies_->segments();
  if (!moved.empty())
    std::memcpy(segments_->host<ExactSegment>().data() + walls_.size(), moved.data(), moved.size_bytes());
}

CellKey Scene::key_of(const Viewpoint& view) const {
  const FamilyTables& family = *families_[view.family];
  const bool inside = family.sight->inside_solid({view.X_WS.x, view.X_WS.y});
  return {2 * std::int64_t{view.family} + inside,
          static_cast<std::int64_t>(std::floor(view.X_WS.x / family.shape.size)),
          static_cast<std::int64_t>(std::floor(view.X_WS.y / family.shape.size))};
}

Vec2 Scene::centre_of(const FamilyTables& family, const CellKey& key) const {
  return {(static_cast<double>(key.x) + 0.5) * family.shape.size,
          (static_cast<double>(key.y) + 0.5) * family.shape.size};
}

void Scene::find_cells(std::span<const Viewpoint> views) {
  keys_.resize(views.size());
  workers_.run(views.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const bool same = i > first && views[i].family == views[i - 1].family && views[i].X_WS.x == views[i - 1].X_WS.x &&
                        views[i].X_WS.y == views[i - 1].X_WS.y;
      keys_[i] = same ? keys_[i - 1] : key_of(views[i]);
    }
  });
  pool_.begin_tick();
  missing_.clear();
  for (const CellKey& key : keys_)
    if (pool_.find(key) == CellPool::kNone) missing_.push_back(key);
  const auto order = [](const CellKey& p, const CellKey& q) {
    return std::tie(p.family, p.x, p.y) < std::tie(q.family, q.x, q.y);
  };
  std::sort(missing_.begin(), missing_.end(), order);
  missing_.erase(std::unique(missing_.begin(), missing_.end()), missing_.end());
}

ListTables Scene::tables() {
  return {entries_->host<ListEntry>().data(), ids_->host<std::uint32_t>().data(), nearest_->host<float>().data(),
          words_.data()};
}

void Scene::build_missing() {
  std::mutex pool_lock;
  const ListTables out = tables();
  ListHeader* const headers = headers_->host<ListHeader>().data();
  std::uint32_t longest = 0;
  workers_.run(missing_.size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    Scratch& scratch = *scratch_[thread];
    for (std::size_t i = first; i < last; ++i) {
      const CellKey& key = missing_[i];
      const FamilyTables& family = *families_[static_cast<std::size_t>(key.family / 2)];
      collect(*family.sight, family.shape, centre_of(family, key), key.family % 2 == 1, scratch.nearby, scratch.lists);
      std::uint32_t slot;
      {
        const std::scoped_lock guard(pool_lock);
        for (std::uint32_t s = 0; s < SF_SECTORS; ++s) longest = std::max(longest, scratch.lists.chunks(s));
        slot = longest > kMostWallChunks ? CellPool::kNone : pool_.insert(key, scratch.lists.all_chunks());
        if (slot != CellPool::kNone) fresh_slots_.push_back(slot);
      }
      if (slot != CellPool::kNone)
        write_lists(scratch.lists, pool_.first_chunk(slot), out, headers + std::size_t{SF_SECTORS} * slot);
    }
  });
  refuse_if_too_long(longest, kMostWallChunks, "walls");
  forget_found();
}

void Scene::forget_found() {
  std::erase_if(missing_, [this](const CellKey& key) { return pool_.find(key) != CellPool::kNone; });
}

bool Scene::serve(std::span<const Viewpoint> views, std::span<RayRow> rows) {
  replaced_ = false;
  find_cells(views);
  for (build_missing(); !missing_.empty(); build_missing())
    grow(2 * options_.pool_cells + 64, 2 * options_.pool_chunks + 4096, view_capacity_, mover_chunks_);
  workers_.run(views.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) fill_walls(views[i], i, rows[i]);
  });

  find_groups(views);
  if (groups_.size() > view_capacity_)
    grow(options_.pool_cells, options_.pool_chunks, static_cast<std::uint32_t>(2 * groups_.size()), mover_chunks_);
  while (!fill_some_movers(views))
    grow(options_.pool_cells, options_.pool_chunks, view_capacity_, 2 * mover_chunks_used_);
  name_movers(views, rows);
  return replaced_;
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
  out.wall_lists = SF_SECTORS * pool_.slot_of(keys_[row]);
  out.origin_x = view.X_WS.x;
  out.origin_y = view.X_WS.y;
  out.range_max = family.family.range;
}

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
      group.in_solid = group.in_solid || keys_[i].family % 2 == 1;
    }
    group.end = i;
    if (low.x != high.x || low.y != high.y) {
      group.origin = 0.5 * (low + high);
      group.radius = 0.5 * length(high - low) * (1.0 + 1e-9) + 1e-9;
    }
    groups_.push_back(group);
  }
}

bool Scene::fill_some_movers(std::span<const Viewpoint> views) {
  std::atomic<std::uint32_t> next{0};
  std::atomic<std::uint32_t> longest{0};
  const ListTables out = tables();
  ListHeader* const headers = headers_->host<ListHeader>().data() + std::size_t{SF_SECTORS} * options_.pool_cells;
  workers_.run(groups_.size(), 16, [&](std::size_t first, std::size_t last, unsigned thread) {
    Scratch& scratch = *scratch_[thread];
    for (std::size_t i = first; i < last; ++i) {
      const Group& group = groups_[i];
      const Viewpoint& view = views[group.first];
      const FamilyTables& family = *families_[view.family];
      const double fov = group.end - group.first == 1 ? family.family.fov : 2.0 * M_PI;
      float clearances[SF_SECTORS];
      bodies_->collect({group.origin, group.radius, family.height, view.X_WS.yaw, fov, family.family.range,
                        family.shape.spread, view.self, group.in_solid ? nullptr : family.depth},
                       scratch.bodies, scratch.lists, clearances);
      const std::uint32_t chunks = scratch.lists.all_chunks();
      const std::uint32_t at = next.fetch_add(chunks);
      for (std::uint32_t s = 0; s < SF_SECTORS; ++s)
        if (scratch.lists.chunks(s) > kMostMoverChunks) longest = scratch.lists.chunks(s);
      if (at + chunks > mover_chunks_) continue;
      ListHeader* const own = headers + SF_SECTORS * i;
      write_lists(scratch.lists, options_.pool_chunks + at, out, own);
      for (std::uint32_t s = 0; s < SF_SECTORS; ++s) own[s].clearance = clearances[s];
    }
  });
  refuse_if_too_long(longest, kMostMoverChunks, "movers");
  mover_chunks_used_ = next;
  return mover_chunks_used_ <= mover_chunks_;
}

void Scene::name_movers(std::span<const Viewpoint> views, std::span<RayRow> rows) const {
  for (std::size_t g = 0; g < groups_.size(); ++g)
    for (std::size_t i = groups_[g].first; i < groups_[g].end; ++i) {
      rows[i].mover_lists = static_cast<std::uint32_t>(SF_SECTORS * (options_.pool_cells + g));
      rows[i].mover_offset_x = static_cast<float>(views[i].X_WS.x - groups_[g].origin.x);
      rows[i].mover_offset_y = static_cast<float>(views[i].X_WS.y - groups_[g].origin.y);
    }
}

void Scene::grow(std::uint32_t pool_cells, std::uint32_t pool_chunks, std::uint32_t views, std::uint32_t mover_chunks) {
  const auto replace = [&](std::unique_ptr<gpu::Buffer>& table, gpu::Texel texel, std::size_t texels) {
    auto larger = std::make_unique<gpu::Buffer>(device_, gpu::Role::upload, texel, texels);
    if (table) std::memcpy(larger->host<std::uint8_t>().data(), table->host<std::uint8_t>().data(), table->bytes());
    table = std::move(larger);
  };
  const std::size_t chunks = std::size_t{pool_chunks} + mover_chunks;
  if (chunks != std::size_t{options_.pool_chunks} + mover_chunks_ || !entries_) {
    replace(entries_, gpu::Texel::f32x4, SF_CHUNK * chunks);
    replace(ids_, gpu::Texel::u32, SF_CHUNK * chunks);
    replace(nearest_, gpu::Texel::f32, chunks);
  }
  if (pool_cells != options_.pool_cells || views != view_capacity_)
    replace(headers_, gpu::Texel::u32x4, std::size_t{SF_SECTORS} * (pool_cells + views));
  pool_.grow(pool_cells, pool_chunks);
  options_ = {pool_chunks, pool_cells};
  view_capacity_ = views;
  mover_chunks_ = mover_chunks;
  replaced_ = upload_all_ = true;
}

void Scene::upload(gpu::Batch& batch) {
  const std::size_t pool = options_.pool_chunks;
  const auto chunks_up = [&](std::size_t first, std::size_t count) {
    batch.up(*entries_, first * SF_CHUNK * 16, count * SF_CHUNK * 16);
    batch.up(*ids_, first * SF_CHUNK * 4, count * SF_CHUNK * 4);
    batch.up(*nearest_, first * 4, count * 4);
  };
  if (upload_all_) {
    chunks_up(0, pool + mover_chunks_used_);
    batch.up(*headers_, 0, headers_->bytes());
    batch.up(*segments_, 0, segments_->bytes());
    batch.up(*models_, 0, models_->bytes());
  } else {
    for (const std::uint32_t slot : fresh_slots_) {
      const ListHeader* own = headers_->host<ListHeader>().data() + std::size_t{SF_SECTORS} * slot;
      const ListHeader& last = own[SF_SECTORS - 1];
      chunks_up(own->first, last.first + last.count - own->first);
      batch.up(*headers_, std::size_t{SF_SECTORS} * slot * 16, SF_SECTORS * 16);
    }
    chunks_up(pool, mover_chunks_used_);
    batch.up(*headers_, std::size_t{SF_SECTORS} * options_.pool_cells * 16, groups_.size() * SF_SECTORS * 16);
    batch.up(*segments_, walls_.size() * sizeof(ExactSegment), bodies_->segments().size_bytes());
  }
  upload_all_ = false;
  fresh_slots_.clear();
}

Scene::Counts Scene::counts() const { return {pool_.built(), pool_.cells()}; }

}  // namespace sf::sensors
