#pragma once
// Reference maps: everything that a robot's laser can see of a world.

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "maps/grid.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::scenarios {

/// Returns a reference map: everything that the robot's first laser can see from poses that the robot can reach without
/// touching a wall, which are the centres of all cells of `geometry` connected to the robot's start, with sixteen
/// headings. A cell is free if its centre is visible, occupied if a wall in it is visible, and unexplored otherwise.
/// Behind a gap, a cell is visible if one of the two cells next to the gap is. Ignores movers. Takes about ten
/// microseconds per cell.
/// @param progress called with the completed fraction, in [0, 1]; an exception from it ends the search
maps::OccupancyGrid visible_area(const world::World& world, std::uint32_t mover, const maps::GridGeometry& geometry,
                                 const std::function<void(double)>& progress = {});

struct SeenArea;

/// Caches `visible_area` for all worlds with equal walls in this process. Robots of one shape whose positions are
/// connected share a result. The world and its sensors must outlive it; they may grow.
class VisibleArea {
 public:
  VisibleArea(const world::World& world, const sensors::SensorSet& sensor_set);
  /// The result lives as long as this object.
  const maps::OccupancyGrid& of(std::uint32_t mover, const maps::GridGeometry& geometry,
                                const std::function<void(double)>& progress = {});

 private:
  const world::World& world_;
  const sensors::SensorSet& sensor_set_;
  std::uint64_t walls_;  ///< hash
  std::vector<std::shared_ptr<const SeenArea>> used_;
};

}  // namespace sf::scenarios
