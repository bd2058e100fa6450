#include "raycast/host_scene.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "raycast/wall_blocks.h"

namespace sf::raycast {

namespace {

constexpr std::uint32_t kPageBlocks = 4;
/// Number of blocks that can be projected to all beams in the time that one beam needs to find its nearest segment with
/// an index.
constexpr double kBlocksPerIndexedBeam = 0.4;
constexpr std::uint32_t kFirstCells = 256, kFirstBlocks = 1u << 11;
/// [blocks] Robots return to their cells. Up to this size per view (21 KiB), and 42 MiB in total, the cache grows
/// instead of evicting cells.
constexpr std::size_t kKeptPerView = 64, kMostKept = 1u << 17;
/// Returns the limit of the cache [blocks]: a quarter of the machine's memory, between 0.7 and 2.7 GiB (100 000 robots
/// need 1.4 GiB). A cell that does not fit is rebuilt by each scan.
std::uint32_t most_blocks() {
  const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return static_cast<std::uint32_t>(std::clamp(0.25 * memory / sizeof(SegmentBlock), 0x1p21, 0x1p23));
}

/// Returns whether a scan of this many beams is faster with the index of a crowd than with its blocks.
bool reads_by_bearing(const CrowdCell& crowd, std::size_t beams) {
  return !crowd.by_bearing.empty() &&
         kBlocksPerIndexedBeam * static_cast<double>(beams) < static_cast<double>(crowd.blocks.size());
}

}  // namespace

struct HostScene::Thread {
  Rasterizer rasterizer;
  CandidateWalls walls;
  std::vector<SegmentBlock> blocks;
  std::vector<BlockBounds> bounds;
  std::vector<SegmentBlock> crowd;  ///< blocks of a crowd without the viewer's own edges
};

HostScene::HostScene(const world::World& world, const ListConfigs& configs, base::ThreadPool& thread_pool)
    : thread_pool_(thread_pool),
      configs_(configs),
      movers_(world),
      crowds_(movers_),
      cells_(configs, coarse_cell_size, CellCache(kFirstCells, kFirstBlocks, kPageBlocks)),
      lists_(kFirstCells),
      blocks_(kFirstBlocks),
      bounds_(kFirstBlocks + kBlock) {
  for (std::size_t i = 0; i < configs.size(); ++i) shapes_.push_back({cells_.size_of(i), configs[i].range});
  for (const world::Segment& s : configs.walls()) {
    exact_.push_back({s.a.x, s.a.y, s.b.x, s.b.y});
    models_.push_back(s.model);
  }
  add_outlines();
  for (unsigned i = 0; i < thread_pool.threads(); ++i) threads_.push_back(std::make_unique<Thread>());
}

HostScene::~HostScene() = default;

void HostScene::add_outlines() {
  const std::size_t walls = configs_.walls().size();
  exact_.resize(walls + movers_.segments());
  models_.resize(walls);
  models_.insert(models_.end(), movers_.models().begin(), movers_.models().end());
}

void HostScene::update_outlines(const world::World& world) {
  if (!movers_.update(world)) {
    movers_ = MoverGeometry(world);
    add_outlines();
  }
  crowds_.update_outlines();
}

void HostScene::place_movers(std::span<const base::Report> states) {
  if (movers_.segments() > 0) movers_.place(states, thread_pool_, std::span(exact_).subspan(configs_.walls().size()));
}

/// Collects the blocks of a cell into the thread's scratch.
HostScene::Cell HostScene::collect(const CellKey& key, Thread& t) const {
  const std::size_t config = ViewCells::config_of(key);
  find_candidate_walls(configs_.wall_index(), shapes_[config], cells_.centre_of(key), configs_.z_of(key.level),
                       ViewCells::in_solid(key), t.walls);
  Cell cell;
  t.blocks.clear(), t.bounds.clear();
  append_blocks(t.walls.front_facing, t.blocks, t.bounds);
  cell.front_facing = static_cast<std::uint32_t>(t.blocks.size());
  append_blocks(t.walls.back_facing, t.blocks, t.bounds);
  cell.all = static_cast<std::uint32_t>(t.blocks.size());
  t.bounds.resize(cell.all + kBlock);
  return cell;
}

void HostScene::build_missing_cells() {
  std::mutex lock;
  std::atomic<bool> no_room{false};  // the other threads stop; the pool must grow first
  thread_pool_.parallel_for(cells_.missing().size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    Thread& t = *threads_[thread];
    for (std::size_t i = first; i < last && !no_room; ++i) {
      const CellKey& key = cells_.missing()[i];
      Cell cell = collect(key, t);
      std::uint32_t slot;
      {
        const std::scoped_lock guard(lock);
        slot = cells_.cache().insert(key, cell.all);
      }
      if (slot == CellCache::kNone) {
        no_room = true;
        break;
      }
      cell.first = cells_.cache().first_chunk(slot);
      lists_[slot] = cell;
      cells_.find_clear_parts(key, slot, t.walls.near);
      std::copy_n(t.blocks.begin(), cell.all, blocks_.begin() + static_cast<std::ptrdiff_t>(cell.first));
      std::copy_n(t.bounds.begin(), cell.all, bounds_.begin() + static_cast<std::ptrdiff_t>(cell.first));
    }
  });
  cells_.drop_cached();
}

void HostScene::prepare(std::span<const Viewpoint> views) {
  views_.assign(views.begin(), views.end());
  cells_.find(views, thread_pool_);
  if (movers_.segments() > 0) crowds_.find(views, thread_pool_);
  static const std::uint32_t most = most_blocks();
  const std::size_t kept = std::min(kKeptPerView * views.size(), kMostKept);
  blocks_.reserve(kept), bounds_.reserve(kept + kBlock);  // growing to this size copies no blocks
  const std::uint64_t evicted = cells_.cache().evicted();
  for (build_missing_cells(); !cells_.missing().empty() && blocks_.size() < most; build_missing_cells()) grow();
  if (cells_.cache().evicted() != evicted && blocks_.size() < kept) grow();
}

void HostScene::grow() {
  lists_.resize(2 * lists_.size());
  blocks_.resize(2 * blocks_.size());
  bounds_.resize(blocks_.size() + kBlock);
  cells_.grow(static_cast<std::uint32_t>(lists_.size()), static_cast<std::uint32_t>(blocks_.size()));
}

/// Prefetches the cell of view `i`, which is usually scanned next.
void HostScene::prefetch(std::size_t i) const {
  if (i + 1 >= views_.size()) return;
  if (cells_.slot(i + 1) != CellCache::kNone) __builtin_prefetch(&lists_[cells_.slot(i + 1)]);
  if (cells_.slot(i) == CellCache::kNone) return;
  const std::uint32_t first = lists_[cells_.slot(i)].first;
  raycast::prefetch(&bounds_[first], kBlock * sizeof(BlockBounds));
  raycast::prefetch(&blocks_[first], 2 * sizeof(SegmentBlock));
}

void HostScene::add_crowd(const CrowdCell& crowd, std::size_t beams, Thread& t, glm::dvec2 origin,
                          ScanScene& scene) const {
  std::span<const SegmentBlock> blocks = crowd.blocks;
  scene.crowd_members = crowd.members;
  scene.crowd_horizon = crowd.horizon;
  scene.crowd.offset = origin - crowd.centre;
  if (reads_by_bearing(crowd, beams)) {
    scene.crowd_index = &crowd.by_bearing;
    return;
  }
  if (scene.in_crowd(scene.self)) {
    t.crowd.assign(blocks.begin(), blocks.end());
    hide_rows(t.crowd, scene.own_first, scene.own_end);
    blocks = t.crowd;
  }
  scene.crowd.blocks = blocks;
  scene.crowd.front_facing = static_cast<std::uint32_t>(blocks.size());
  scene.crowd.bounds = crowd.bounds.data();
}

bool HostScene::scan(std::size_t i, ScanView from, const ScanPattern& pattern, unsigned thread, const ScanOutput& out) {
  Thread& t = *threads_[thread];
  const Viewpoint& view = views_[i];
  const std::uint32_t slot = cells_.slot(i);
  const bool listed = slot != CellCache::kNone;
  const Cell cell = listed ? lists_[slot] : collect(cells_.key(i), t);
  const std::span<const SegmentBlock> blocks =
      listed ? std::span<const SegmentBlock>(blocks_).subspan(cell.first, cell.all) : t.blocks;
  prefetch(i + 1);
  const glm::dvec2 centre = cells_.centre_of(cells_.key(i));
  const glm::dvec2 origin{view.X_WS.x, view.X_WS.y};
  from.origin = origin;
  from.range_max = configs_[view.config].range;
  from.band = static_cast<float>(SF_COORDINATE_ERROR * (shapes_[view.config].reach() + 2.0 * movers_.largest_radius()));
  ScanScene scene;
  scene.walls = {blocks, cell.front_facing, listed ? &bounds_[cell.first] : t.bounds.data(), origin - centre};
  scene.exact = exact_;
  scene.models = models_;
  scene.movers = movers_.segments() > 0 ? &movers_.grid() : nullptr;
  scene.outlines = &movers_.outlines();
  scene.z = view.X_WS.z;
  scene.states = movers_.states();
  scene.headings = movers_.headings();
  scene.first_rows = movers_.first_rows();
  scene.self = view.self;
  if (view.self != kNoMover)
    scene.own_first = scene.first_rows[view.self], scene.own_end = scene.first_rows[view.self + 1];
  if (const CrowdCell* crowd = scene.movers != nullptr ? crowds_.of(i) : nullptr; crowd != nullptr)
    add_crowd(*crowd, pattern.beams, t, origin, scene);
  return t.rasterizer.scan(from, pattern, scene, out);
}

ScanCounts HostScene::counts() const {
  ScanCounts sum;
  for (const auto& thread : threads_) {
    const ScanCounts& own = thread->rasterizer.counts();
    sum.uncertain += own.uncertain, sum.movers_in_range += own.movers_in_range,
        sum.movers_visible += own.movers_visible, sum.blocks += own.blocks, sum.decisions += own.decisions;
  }
  return sum;
}

}  // namespace sf::raycast
