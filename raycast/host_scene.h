#pragma once
// Scene for scans on the host: movers, and lists of walls per cell around the sensors.

#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "base/thread_pool.h"
#include "raycast/candidate_walls.h"
#include "raycast/crowds.h"
#include "raycast/mover_geometry.h"
#include "raycast/rasterizer.h"
#include "raycast/scene_options.h"
#include "raycast/view_cells.h"

namespace sf::raycast {

/// Allocates elements without initializing them.
template <class T>
struct UninitializedAllocator : std::allocator<T> {
  template <class Other>
  struct rebind {
    using other = UninitializedAllocator<Other>;
  };
  template <class Element, class... From>
  void construct(Element* at, From&&... from) {
    if constexpr (sizeof...(From) == 0)
      ::new (static_cast<void*>(at)) Element;
    else
      std::construct_at(at, std::forward<From>(from)...);
  }
};

/// Not thread-safe, except for `scan`. `world` may be destroyed after construction.
class HostScene {
 public:
  /// @param configs complete list of configs, built for `world`; must outlive this object
  HostScene(const world::World& world, const ListConfigs& configs, base::ThreadPool& thread_pool);
  ~HostScene();

  /// Moves the movers to this tick's poses. @param states one per mover; after a change, call again before `prepare`
  void place_movers(std::span<const base::Report> states);
  /// Replaces the movers' outlines by those of `world`, which has the same walls. Call `place_movers` before `prepare`.
  void update_outlines(const world::World& world);
  /// Builds the lists of `views`.
  void prepare(std::span<const Viewpoint> views);
  /// Scans from view `i` of the last `prepare`.
  /// @param from origin, range_max and band are overwritten
  /// @param thread index of the calling pool thread
  /// @return true if any beam grazes a surface; `out.grazes` is filled in only then
  bool scan(std::size_t i, ScanView from, const ScanPattern& pattern, unsigned thread, const ScanOutput& out);

  std::uint64_t cells_built() const { return cells_.cache().built(); }
  ScanCounts counts() const;

 private:
  struct Thread;
  /// Blocks of one cell: front-facing ones, then back-facing ones, which are needed only for ties at corners.
  struct Cell {
    std::uint32_t first = 0, front_facing = 0, all = 0;
  };
  void add_outlines();
  void build_missing_cells();
  void grow();
  void prefetch(std::size_t i) const;
  Cell collect(const CellKey& key, Thread& thread) const;
  void add_crowd(const CrowdCell& crowd, std::size_t beams, Thread& thread, glm::dvec2 origin, ScanScene& scene) const;

  base::ThreadPool& thread_pool_;
  const ListConfigs& configs_;
  std::vector<CellShape> shapes_;  ///< per list config
  MoverGeometry movers_;
  Crowds crowds_;
  std::vector<ExactSegment> exact_;  ///< walls, then movers
  std::vector<std::uint32_t> models_;
  ViewCells cells_;
  std::vector<Cell> lists_;                                                 ///< per slot
  std::vector<SegmentBlock, UninitializedAllocator<SegmentBlock>> blocks_;  ///< of all cells
  std::vector<BlockBounds> bounds_;                                         ///< of each block, padded by kBlock
  std::vector<Viewpoint> views_;
  std::vector<std::unique_ptr<Thread>> threads_;
};

}  // namespace sf::raycast
