#include "raycast/host_scene.h"

#include <unistd.h>

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
/// [blocks] A quarter of the machine's memory, between 0.7 and 2.7 GiB (100 000 robots need 1.4): a cell for which
/// there is no room is listed anew by each scan.
std::uint32_t most_blocks() {
  const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return static_cast<std::uint32_t>(std::clamp(0.25 * memory / sizeof(SegmentBlock), 0x1p21, 0x1p23));
}

/// [m] An eighth of the range for a scanner of some hundred beams, more for fewer, and not less than 0.25 m or the
/// range: smaller cells cost more to make than they save where robots drive.
double cell_size(double range, std::uint32_t beams) {
  const double fewer = std::clamp(std::sqrt(361.0 / std::max(1u, beams)), 1.0, 4.0);
  return std::clamp(fewer * range / 8.0, std::clamp(range, 1e-3, 0.25), 4.0);
}

/// Blocks of a cell for which directions are known.
constexpr std::size_t kMostAhead = 64;

BlocksAhead blocks_ahead(std::span<const SegmentBlock> blocks) {
  constexpr double kPerRadian = kSectors / (2.0 * M_PI);
  BlocksAhead ahead{};
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const double middle = static_cast<double>(blocks[b].bearing) * kPerRadian;
    const double wide = std::min(static_cast<double>(blocks[b].half) * kPerRadian + 1e-3, 0.5 * kSectors);
    const auto first = static_cast<int>(std::floor(middle - wide)), last = static_cast<int>(std::floor(middle + wide));
    for (int i = first; i <= last; ++i) ahead[static_cast<std::size_t>(i & (kSectors - 1))] |= std::uint64_t{1} << b;
  }
  return ahead;
}

/// Rings in which distances double: segments of one are listed by bearing, so that blocks are narrow and can be hidden.
constexpr double kRings = 2.0;

}  // namespace

struct HostScene::FamilyTables {
  CellShape shape;
  std::uint32_t height;
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

HostScene::HostScene(const world::World& world, const Families& families, base::Workers& workers)
    : workers_(workers),
      families_(families),
      movers_(world),
      cells_(families, cell_size, CellPool(kFirstCells, kFirstBlocks, kPageBlocks)),
      lists_(kFirstCells),
      ahead_(kFirstCells),
      blocks_(kFirstBlocks) {
  for (std::size_t i = 0; i < families.size(); ++i) {
    const Family& family = families[i];
    tables_of_.push_back({{cells_.size_of(i), family.range, 0.0}, movers_.watch_height(family.z)});
  }
  for (const world::Segment& s : families.walls()) {
    exact_.push_back({s.a.x, s.a.y, s.b.x, s.b.y});
    models_.push_back(s.model);
  }
  exact_.resize(exact_.size() + movers_.segments());
  models_.insert(models_.end(), movers_.models().begin(), movers_.models().end());
  for (unsigned i = 0; i < workers.threads(); ++i) threads_.push_back(std::make_unique<Thread>());
}

HostScene::~HostScene() = default;

void HostScene::place(std::span<const Pose> poses) {
  movers_.place(poses, workers_, std::span(exact_).subspan(families_.walls().size()));
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
  const CellShape& shape = tables_of_[ViewCells::family_of(key)].shape;
  const Sight& sight = families_.sight(ViewCells::family_of(key));
  const Vec2 centre = cells_.centre_of(key);
  const double radius = shape.radius();
  const bool both_sides = ViewCells::in_solid(key);
  Cell cell;
  t.facing.clear();
  t.behind.clear();
  sight.near(centre, shape.reach(), t.nearby);
  for (const std::uint32_t i : t.nearby.found) {
    const SightSegment& s = sight.segments()[i];
    Vec2 a = s.a - centre, b = s.b - centre;
    if (!clip(a, b, shape.reach())) continue;
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
  std::atomic<bool> no_room{false};  // the others wait for the pool to grow
  workers_.run(cells_.missing().size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    Thread& t = *threads_[thread];
    for (std::size_t i = first; i < last && !no_room; ++i) {
      const CellKey& key = cells_.missing()[i];
      Cell cell = collect(key, t);
      std::uint32_t slot;
      {
        const std::scoped_lock guard(lock);
        slot = cells_.pool().insert(key, cell.all);
      }
      if (slot == CellPool::kNone) {
        no_room = true;
        break;
      }
      cell.first = cells_.pool().first_chunk(slot);
      lists_[slot] = cell;
      if (cell.all <= kMostAhead) ahead_[slot] = blocks_ahead(t.blocks);
      cells_.note_sides(key, slot, t.nearby);
      std::copy(t.blocks.begin(), t.blocks.end(), blocks_.begin() + static_cast<std::ptrdiff_t>(cell.first));
    }
  });
  cells_.forget_found();
}

void HostScene::prepare(std::span<const Viewpoint> views) {
  views_.assign(views.begin(), views.end());
  cells_.find(views, workers_);
  static const std::uint32_t most = most_blocks();
  for (build_missing(); !cells_.missing().empty() && blocks_.size() < most; build_missing()) {
    lists_.resize(2 * lists_.size());
    ahead_.resize(lists_.size());
    blocks_.resize(2 * blocks_.size());
    cells_.grow(static_cast<std::uint32_t>(lists_.size()), static_cast<std::uint32_t>(blocks_.size()));
  }
}

bool HostScene::scan(std::size_t i, ScanView from, const ScanPattern& pattern, unsigned thread, const ScanOutput& out) {
  Thread& t = *threads_[thread];
  const Viewpoint& view = views_[i];
  const FamilyTables& family = tables_of_[view.family];
  const std::uint32_t slot = cells_.slot(i);
  const bool listed = slot != CellPool::kNone;
  const Cell cell = listed ? lists_[slot] : collect(cells_.key(i), t);
  const std::span<const SegmentBlock> blocks =
      listed ? std::span<const SegmentBlock>(blocks_).subspan(cell.first, cell.all) : t.blocks;
  const Vec2 centre = cells_.centre_of(cells_.key(i));
  const Vec2 origin{view.X_WS.x, view.X_WS.y};
  from.origin = origin;
  from.offset = origin - centre;
  from.range_max = families_[view.family].range;
  from.band = static_cast<float>(SF_BAND * (family.shape.reach() + 2.0 * movers_.largest_radius()));
  ScanScene scene;
  scene.walls = blocks;
  scene.facing = cell.facing;
  if (listed && cell.all <= kMostAhead) scene.ahead = &ahead_[slot];
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
