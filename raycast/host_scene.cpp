#include "raycast/host_scene.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <tuple>

namespace sf::raycast {

namespace {

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

}  // namespace

struct HostScene::FamilyTables {
  CellShape shape;
  std::uint32_t height;
};

struct HostScene::Thread {
  Rasterizer rasterizer;
  FoundWalls walls;
  std::vector<SegmentBlock> blocks;
};

HostScene::HostScene(const world::World& world, const Families& families, base::ThreadPool& thread_pool)
    : thread_pool_(thread_pool),
      families_(families),
      movers_(world),
      cells_(families, cell_size, CellPool(kFirstCells, kFirstBlocks, kPageBlocks)),
      lists_(kFirstCells),
      ahead_(kFirstCells),
      blocks_(kFirstBlocks) {
  for (std::size_t i = 0; i < families.size(); ++i) {
    const Family& family = families[i];
    tables_of_.push_back({{cells_.size_of(i), family.range}, movers_.watch_height(family.z)});
  }
  for (const world::Segment& s : families.walls()) {
    exact_.push_back({s.a.x, s.a.y, s.b.x, s.b.y});
    models_.push_back(s.model);
  }
  exact_.resize(exact_.size() + movers_.segments());
  models_.insert(models_.end(), movers_.models().begin(), movers_.models().end());
  for (unsigned i = 0; i < thread_pool.threads(); ++i) threads_.push_back(std::make_unique<Thread>());
}

HostScene::~HostScene() = default;

void HostScene::place(std::span<const Pose> poses) {
  movers_.place(poses, thread_pool_, std::span(exact_).subspan(families_.walls().size()));
}

/// Appends `found` in order of rings and bearings, with what all of a block have in common.
void HostScene::add_blocks(std::vector<FoundWall>& found, std::vector<SegmentBlock>& blocks) {
  std::sort(found.begin(), found.end(), [](const FoundWall& p, const FoundWall& q) {
    return std::tie(p.ring, p.bearing, p.row, p.a.x, p.a.y) < std::tie(q.ring, q.bearing, q.row, q.a.x, q.a.y);
  });
  std::uint32_t used = kBlock;
  for (std::size_t i = 0; i < found.size(); ++i) {
    append(blocks, used, found[i].a, found[i].b, found[i].row);
    if (used < kBlock && i + 1 < found.size()) continue;
    const std::span<const FoundWall> own = std::span(found).subspan(i + 1 - used, used);
    double low = 0.0, high = 0.0, nearest = own[0].nearest;
    for (const FoundWall& f : own) {
      const double offset = base::wrap_angle(f.bearing - own[0].bearing);
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
  const std::size_t family = ViewCells::family_of(key);
  find_walls(families_.sight(family), tables_of_[family].shape, cells_.centre_of(key), ViewCells::in_solid(key),
             t.walls);
  Cell cell;
  t.blocks.clear();
  add_blocks(t.walls.facing, t.blocks);
  cell.facing = static_cast<std::uint32_t>(t.blocks.size());
  add_blocks(t.walls.behind, t.blocks);
  cell.all = static_cast<std::uint32_t>(t.blocks.size());
  return cell;
}

void HostScene::build_missing() {
  std::mutex lock;
  std::atomic<bool> no_room{false};  // the others wait for the pool to grow
  thread_pool_.parallel_for(cells_.missing().size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
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
      cells_.note_sides(key, slot, t.walls.nearby);
      std::copy(t.blocks.begin(), t.blocks.end(), blocks_.begin() + static_cast<std::ptrdiff_t>(cell.first));
    }
  });
  cells_.forget_found();
}

void HostScene::prepare(std::span<const Viewpoint> views) {
  views_.assign(views.begin(), views.end());
  cells_.find(views, thread_pool_);
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
  const glm::dvec2 centre = cells_.centre_of(cells_.key(i));
  const glm::dvec2 origin{view.X_WS.x, view.X_WS.y};
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
