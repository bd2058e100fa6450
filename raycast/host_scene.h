#pragma once
// The scene of host scans: walls in lists by cell, made where sensors are, and movers.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "raycast/candidate_walls.h"
#include "raycast/mover_geometry.h"
#include "raycast/rasterizer.h"
#include "raycast/scene_options.h"
#include "raycast/view_cells.h"

namespace sf::raycast {

/// Not thread-safe, but for `scan`. `world` need not outlive it.
class HostScene {
 public:
  /// @param families complete, of `world`; to outlive it
  HostScene(const world::World& world, const ListConfigs& configs, base::ThreadPool& thread_pool);
  ~HostScene();

  /// Takes this tick's poses, one per mover.
  void set_poses(std::span<const Pose> poses);
  /// Makes the lists that `views` need.
  void prepare(std::span<const Viewpoint> views);
  /// Scans from the i-th view of the last `prepare`. @param from all but origin, offset, range_max and band, which are
  /// the view's  @param thread of the workers
  /// @return whether any beam grazes: `out.grazes` is filled in only then
  bool scan(std::size_t i, ScanView from, const ScanPattern& pattern, unsigned thread, const ScanOutput& out);

  std::uint64_t cells_built() const { return cells_.cache().built(); }
  ScanCounts counts() const;

 private:
  struct ConfigTables;
  struct Thread;
  /// Blocks of one cell: those that face it, then those that do not, which only decide ties at corners.
  struct Cell {
    std::uint32_t first = 0, front_facing = 0, all = 0;
  };
  void build_missing_cells();
  static void add_blocks(std::vector<CandidateWall>& found, std::vector<SegmentBlock>& blocks);
  Cell collect(const CellKey& key, Thread& thread) const;

  base::ThreadPool& thread_pool_;
  const ListConfigs& configs_;
  std::vector<ConfigTables> config_tables_;  ///< per family
  MoverGeometry movers_;
  std::vector<ExactSegment> exact_;  ///< walls, then movers
  std::vector<std::uint32_t> models_;
  ViewCells cells_;
  std::vector<Cell> lists_;                    ///< per slot
  std::vector<SectorBlockMasks> block_masks_;  ///< per slot
  std::vector<SegmentBlock> blocks_;           ///< of all cells
  std::vector<Viewpoint> views_;
  std::vector<std::unique_ptr<Thread>> threads_;
};

}  // namespace sf::raycast
