#pragma once
// Reference maps: all that a robot's laser can see of a world.

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "maps/grid.h"
#include "world/world.h"

namespace sf::scenarios {

/// Reference map: everything that the robot's first laser can see from poses which the robot can reach without touching
/// a wall: from the centres of all cells of `geometry` that are connected to the robot's start, with sixteen headings.
/// Cells are free where their centre is in view, occupied where a wall in them is, and unexplored elsewhere. Behind a
/// gap, cells are seen where one of the two next to the gap is. Movers are ignored. Takes about ten microseconds a
/// cell.
/// @param progress called with the part that is done, in [0, 1]; what it throws ends the search
maps::OccupancyGrid visible_area(const world::World& world, std::uint32_t mover, const maps::GridGeometry& geometry,
                                 const std::function<void(double)>& progress = {});

struct SeenArea;

/// Caches `visible_area`, for all worlds with equal walls in this process. Robots of one shape whose positions are
/// connected share a result. The world must outlive it; its movers may grow.
class VisibleArea {
 public:
  explicit VisibleArea(const world::World& world);
  /// The result lives as long as this.
  const maps::OccupancyGrid& of(std::uint32_t mover, const maps::GridGeometry& geometry,
                                const std::function<void(double)>& progress = {});

 private:
  const world::World& world_;
  std::uint64_t walls_;  ///< hash
  std::vector<std::shared_ptr<const SeenArea>> used_;
};

}  // namespace sf::scenarios
