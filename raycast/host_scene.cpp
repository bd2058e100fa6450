#include "raycast/host_scene.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <tuple>

namespace sf::raycast {

namespace {

using base::Vec2;

constexpr std::uint32_t kPageBlocks = 4;
constexpr std::uint32_t kFirstCells = 256, kFirstBlocks = 1u << 11;
/// [blocks] 640 MiB: a cell for which there is no room is listed anew by each scan.
constexpr std::uint32_t kMostBlocks = 1u << 21;

/// [m] An eighth of the range for a scanner of some hundred beams, more for fewer, and not less than 0.25 m or the
/// range: smaller cells cost more to make than they save where robots drive.
double cell_size(double range, std::uint32_t beams) {
  const double fewer = std::clamp(std::sqrt(361.0 / std::max(1u, beams)), 1.0, 4.0);
  return std::clamp(fewer * range / 8.0, std::clamp(range, 1e-3, 0.25), 4.0);
}

/// Rings in which distances double: segments of one are listed by bearing, so that blocks are narrow and can be hidden.
constexpr double kRings = 2.0;

}  // namespace

struct HostScene::FamilyTables {
  Family family;
  CellShape shape;
  const Sight* sight = nullptr;
  std::uint32_t height = 0;
};

/// A segment seen from its right, relative to a cell's centre.
struct HostScene::Found {
  Vec2 a, b;
  std::uint32_t row;
  double nearest;        ///< [m] to any viewer
  double bearing, half;  ///< [rad] where viewers see it
  int ring;              ///< steps of distance; in each, by bearing
};

struct HostScene::Thread {
  Rasterizer rasterizer;
  Sight::Nearby nearby;
  std::vector<Found> facing, behind;
  std::vector<SegmentBlock> blocks;
};

HostScene::HostScene(const world::World& world, base::Workers& workers)
    : workers_(workers),
      walls_(world.walls),
      breaks_(height_breaks(walls_)),
      movers_(world),
      pool_(kFirstCells, kFirstBlocks, kPageBlocks),
      cells_(kFirstCells),
      blocks_(kFirstBlocks) {
  for (const world::Segment& s : walls_) {
    exact_.push_back({s.a.x, s.a.y, s.b.x, s.b.y});
    models_.push_back(s.model);
  }
  exact_.resize(walls_.size() + movers_.segments());
  models_.insert(models_.end(), movers_.models().begin(), movers_.models().end());
  for (unsigned i = 0; i < workers.threads(); ++i) threads_.push_back(std::make_unique<Thread>());
}

HostScene::~HostScene() = default;

std::uint32_t HostScene::add_family(const Family& family) {
  const auto interval =
      static_cast<std::size_t>(std::upper_bound(breaks_.begin(), breaks_.end(), family.z) - breaks_.begin());
  auto& sight = sights_[interval];
  if (!sight) {
    world::World view;
    view.walls = walls_;
    sight = std::make_unique<Sight>(view, family.z, family.range);
  }
  for (std::uint32_t i = 0; i < families_.size(); ++i) {
    const FamilyTables& known = *families_[i];
    if (known.sight == sight.get() && known.family.range == family.range && known.family.z == family.z) return i;
  }
  families_.push_back(
      std::make_unique<FamilyTables>(FamilyTables{family,
                                                  {cell_size(family.range, family.beams), family.range, 0.0},
                                                  sight.get(),
                                                  movers_.watch_height(family.z)}));
  return static_cast<std::uint32_t>(families_.size() - 1);
}

void HostScene::place(std::span<const Pose> poses) {
  movers_.place(poses, workers_, std::span(exact_).subspan(walls_.size()));
}

CellKey HostScene::key_of(const Viewpoint& view) const {
  const FamilyTables& family = *families_[view.family];
  CellKey key{2 * std::int64_t{view.family}, static_cast<std::int64_t>(std::floor(view.X_WS.x / family.shape.size)),
              static_cast<std::int64_t>(std::floor(view.X_WS.y / family.shape.size))};
  // A cell without a surface is on one side as a whole: whoever stood in it before has found out.
  const auto known = [&] {
    const std::uint32_t slot = pool_.slot_of(key);
    return slot != CellPool::kNone && cells_[slot].uniform;
  };
  if (known()) return key;
  key.family |= 1;
  if (known() || family.sight->inside_solid({view.X_WS.x, view.X_WS.y})) return key;
  key.family &= ~std::int64_t{1};
  return key;
}

Vec2 HostScene::centre_of(const CellKey& key) const {
  const double size = families_[static_cast<std::size_t>(key.family / 2)]->shape.size;
  return {(static_cast<double>(key.x) + 0.5) * size, (static_cast<double>(key.y) + 0.5) * size};
}

void HostScene::find_cells() {
  keys_.resize(views_.size());
  slots_.resize(views_.size());
  workers_.run(views_.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const bool same = i > first && views_[i].family == views_[i - 1].family &&
                        views_[i].X_WS.x == views_[i - 1].X_WS.x && views_[i].X_WS.y == views_[i - 1].X_WS.y;
      keys_[i] = same ? keys_[i - 1] : key_of(views_[i]);
      slots_[i] = same ? slots_[i - 1] : pool_.slot_of(keys_[i]);
    }
  });
  pool_.begin_tick();
  missing_.clear();
  for (std::size_t i = 0; i < keys_.size(); ++i)
    slots_[i] != CellPool::kNone ? pool_.keep(slots_[i]) : missing_.push_back(keys_[i]);
  const auto order = [](const CellKey& p, const CellKey& q) {
    return std::tie(p.family, p.x, p.y) < std::tie(q.family, q.x, q.y);
  };
  std::sort(missing_.begin(), missing_.end(), order);
  missing_.erase(std::unique(missing_.begin(), missing_.end()), missing_.end());
}

/// @param radius [m] of the disc that holds all viewers
HostScene::Found HostScene::found(Vec2 a, Vec2 b, std::uint32_t row, double radius) {
  Found f{a, b, row, std::max(0.0, world::distance({}, a, b) - radius), 0.0, 2.0 * M_PI, -1};
  const double distance_a = length(a), distance_b = length(b);
  if (f.nearest <= 0.0 || distance_a <= radius || distance_b <= radius) return f;
  const double bearing_a = std::atan2(a.y, a.x), turn = std::atan2(cross(a, b), dot(a, b));
  const double wide_a = std::asin(radius / distance_a), wide_b = std::asin(radius / distance_b);
  const double low = std::min(-wide_a, turn - wide_b), high = std::max(wide_a, turn + wide_b);
  f.half = 0.5 * (high - low);
  f.bearing = std::remainder(bearing_a + 0.5 * (low + high), 2.0 * M_PI);
  f.ring = static_cast<int>(std::floor(std::log2((f.nearest + radius) / radius) * kRings));
  return f;
}

/// Appends `found` in order of rings and bearings, with what all of a block have in common.
void HostScene::add_blocks(std::vector<Found>& found, std::vector<SegmentBlock>& blocks) {
  std::sort(found.begin(), found.end(), [](const Found& p, const Found& q) {
    return std::tie(p.ring, p.bearing, p.row, p.a.x, p.a.y) < std::tie(q.ring, q.bearing, q.row, q.a.x, q.a.y);
  });
  std::uint32_t used = kBlock;
  for (std::size_t i = 0; i < found.size(); ++i) {
    append(blocks, used, found[i].a, found[i].b, found[i].row);
    if (used < kBlock && i + 1 < found.size()) continue;
    const std::span<const Found> own = std::span(found).subspan(i + 1 - used, used);
    double low = 0.0, high = 0.0, nearest = own[0].nearest;
    for (const Found& f : own) {
      const double offset = std::remainder(f.bearing - own[0].bearing, 2.0 * M_PI);
      low = std::min(low, offset - f.half), high = std::max(high, offset + f.half);
      nearest = std::min(nearest, f.nearest);
    }
    SegmentBlock& block = blocks.back();
    block.nearest = std::nextafter(static_cast<float>(nearest), 0.0f);
    block.bearing = static_cast<float>(own[0].bearing + 0.5 * (low + high));
    block.half = static_cast<float>(0.5 * (high - low));
  }
}

/// Lists what may be met from a cell, into the thread's blocks.
HostScene::Cell HostScene::collect(const CellKey& key, Thread& t) const {
  const FamilyTables& family = *families_[static_cast<std::size_t>(key.family / 2)];
  const Vec2 centre = centre_of(key);
  const double radius = family.shape.radius();
  const bool both_sides = key.family % 2 == 1;
  const double close = radius + 1e-9 * (1.0 + length(centre));
  Cell cell{0, 0, 0, true};
  t.facing.clear();
  t.behind.clear();
  family.sight->near(centre, family.shape.reach(), t.nearby);
  for (const std::uint32_t i : t.nearby.found) {
    const SightSegment& s = family.sight->segments()[i];
    Vec2 a = s.a - centre, b = s.b - centre;
    if (s.solid_left && world::distance({}, a, b) <= close) cell.uniform = false;
    if (!clip(a, b, family.shape.reach())) continue;
    // The cell's signed distance from the segment's line: positive on its left.
    const Vec2 e = s.b - s.a;
    const double side = cross(e, centre - s.a) / length(e);
    const bool both = both_sides || !s.solid_left;
    if (side < radius) t.facing.push_back(found(a, b, s.row, radius));
    if (side > -radius && both) t.facing.push_back(found(b, a, s.row, radius));
    if (side >= radius && !both) t.behind.push_back(found(a, b, s.row, radius));
  }
  t.blocks.clear();
  add_blocks(t.facing, t.blocks);
  cell.facing = static_cast<std::uint32_t>(t.blocks.size());
  add_blocks(t.behind, t.blocks);
  cell.all = static_cast<std::uint32_t>(t.blocks.size());
  return cell;
}

void HostScene::build_missing() {
  std::mutex lock;
  std::atomic<bool> no_room{false};  // whoever comes later waits for the pool to grow
  workers_.run(missing_.size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    Thread& t = *threads_[thread];
    for (std::size_t i = first; i < last && !no_room; ++i) {
      Cell cell = collect(missing_[i], t);
      std::uint32_t slot;
      {
        const std::scoped_lock guard(lock);
        slot = pool_.insert(missing_[i], cell.all);
      }
      if (slot == CellPool::kNone) {
        no_room = true;
        break;
      }
      cell.first = pool_.first_chunk(slot);
      cells_[slot] = cell;
      std::copy(t.blocks.begin(), t.blocks.end(), blocks_.begin() + static_cast<std::ptrdiff_t>(cell.first));
    }
  });
  std::erase_if(missing_, [this](const CellKey& key) { return pool_.find(key) != CellPool::kNone; });
}

void HostScene::prepare(std::span<const Viewpoint> views) {
  views_.assign(views.begin(), views.end());
  find_cells();
  for (build_missing(); !missing_.empty() && blocks_.size() < kMostBlocks; build_missing()) {
    cells_.resize(2 * cells_.size());
    blocks_.resize(2 * blocks_.size());
    pool_.grow(static_cast<std::uint32_t>(cells_.size()), static_cast<std::uint32_t>(blocks_.size()));
  }
  for (std::size_t i = 0; i < keys_.size(); ++i)
    if (slots_[i] == CellPool::kNone) slots_[i] = pool_.slot_of(keys_[i]);
}

bool HostScene::scan(std::size_t i, double range_min, double least_sine, bool single, const ScanPattern& pattern,
                     unsigned thread, const ScanOutput& out) {
  Thread& t = *threads_[thread];
  const Viewpoint& view = views_[i];
  const FamilyTables& family = *families_[view.family];
  const bool listed = slots_[i] != CellPool::kNone;
  const Cell cell = listed ? cells_[slots_[i]] : collect(keys_[i], t);
  const std::span<const SegmentBlock> blocks =
      listed ? std::span<const SegmentBlock>(blocks_).subspan(cell.first, cell.all) : t.blocks;
  const Vec2 centre = centre_of(keys_[i]);
  const Vec2 origin{view.X_WS.x, view.X_WS.y};
  ScanView from;
  from.origin = origin;
  from.yaw = view.X_WS.yaw;
  from.heading = {std::cos(view.X_WS.yaw), std::sin(view.X_WS.yaw)};
  from.offset = origin - centre;
  from.range_max = family.family.range;
  from.range_min = range_min;
  from.band = static_cast<float>(SF_BAND * (family.shape.reach() + 2.0 * movers_.largest_radius()));
  from.least_sine = least_sine;
  from.single = single;
  ScanScene scene;
  scene.walls = blocks.first(cell.facing);
  scene.behind = blocks.subspan(cell.facing);
  scene.exact = exact_;
  scene.models = models_;
  scene.movers = movers_.segments() > 0 ? &movers_.grid() : nullptr;
  scene.outlines = &movers_.outlines(family.height);
  scene.poses = movers_.poses();
  scene.headings = movers_.headings();
  scene.first_rows = movers_.first_rows();
  scene.self = view.self;
  return t.rasterizer.scan(from, pattern, scene, out);
}

ScanCounts HostScene::counts() const {
  ScanCounts sum;
  for (const auto& thread : threads_) {
    const ScanCounts& own = thread->rasterizer.counts();
    sum.doubts += own.doubts, sum.movers_near += own.movers_near, sum.movers_met += own.movers_met;
  }
  return sum;
}

}  // namespace sf::raycast
