#pragma once
// Maps that robots of a team exchange by radio. Published snapshots are immutable, so that receivers read them from any
// thread.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "maps/grid.h"

namespace sf::control {

/// Measurements that a robot added to its map in some period.
struct MapChanges {
  struct CellState {
    maps::CellAt at;
    maps::Cell state = maps::Cell::unexplored;
  };
  std::vector<CellState> cells;
  std::vector<glm::dvec2> points;   ///< [m] on surfaces, world frame
  std::vector<std::int32_t> nodes;  ///< lattice nodes on surfaces (ExplorationMap)
  bool empty() const { return cells.empty() && points.empty() && nodes.empty(); }
};

/// All measurements of one robot since its start, and the cells that it is about to explore.
struct SharedMap {
  maps::GridGeometry geometry;
  std::vector<std::shared_ptr<const MapChanges>> changes;  ///< oldest first; only ever appended
  std::vector<std::int64_t> claim;                         ///< keys of cells (ExplorationMap), ascending
};

/// The last snapshot of a teammate within radio range.
struct TeammateMap {
  std::uint32_t id = 0;  ///< id in packets
  std::shared_ptr<const SharedMap> map;
};

/// A controller that exchanges maps with others.
class SharesMap {
 public:
  /// Returns whether the controller shares its map. The other functions require this. Constant.
  virtual bool shares_map() const = 0;
  /// Returns the snapshot to broadcast, after a step; null before the first.
  virtual std::shared_ptr<const SharedMap> shared_map() const = 0;
  /// Sets the inputs of the next step, in order of id. Robots out of range and absent robots are not included.
  virtual void receive_maps(std::span<const TeammateMap> maps) = 0;

 protected:
  ~SharesMap() = default;
};

}  // namespace sf::control
