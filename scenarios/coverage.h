#pragma once
// How much of what a robot could see it has seen: its own map beside a reference from the true walls.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/reading.h"
#include "maps/grid.h"
#include "world/world.h"

namespace sf::scenarios {

/// The map that one robot makes of its first laser's scans, from its own pose.
class RobotMap {
 public:
  /// @param cell [m]; the map has the plan of the explorer's own (control/explore.h), or is as large as the world where
  /// that is too large for one.
  /// Rule: the mover has a laser.
  RobotMap(const world::World& world, std::uint32_t mover, double cell = 0.03);
  /// Adds it when it is a scan of that laser.
  void add(const base::ReadingBlock& reading);
  const maps::OccupancyGrid& grid() const { return grid_; }

 private:
  const world::World& world_;
  std::uint32_t mover_;
  maps::OccupancyGrid grid_;
  std::vector<glm::dvec2> beams_;
};

/// Adds each scan to the map of its own mover, where there is one. @param maps by row of their movers
void add_scans(std::span<const base::ReadingBlock> readings, std::map<std::uint32_t, RobotMap>& maps);

/// All that the robot's first laser could see from wherever the robot can go without touching a wall: a map of scans
/// from the middles of all cells of `plan` that are connected to its start, with sixteen headings. Cells whose middle
/// is in view from none of these are left unexplored. Movers are not looked at.
maps::OccupancyGrid visible_area(const world::World& world, std::uint32_t mover, const maps::GridGeometry& plan);

/// `visible_area` in one world, which must outlive it: kept while mover and plan stay the same, since it takes
/// its time.
class VisibleArea {
 public:
  explicit VisibleArea(const world::World& world) : world_(world) {}
  /// Lives until the next call.
  const maps::OccupancyGrid& of(std::uint32_t mover, const maps::GridGeometry& plan);

 private:
  const world::World& world_;
  std::uint32_t mover_ = 0;
  std::optional<maps::OccupancyGrid> grid_;
};

/// The free cells of a reference, and those of them that a map does not know.
struct Coverage {
  std::size_t wanted = 0;
  std::size_t missed = 0;  ///< <= wanted
  /// [-] 1 where nothing is missed, and only there.
  double coverage() const {
    return wanted == 0 ? 1.0 : static_cast<double>(wanted - missed) / static_cast<double>(wanted);
  }
};
/// Known is free, or occupied. Rule: both have the same plan.
Coverage coverage_of(const maps::OccupancyGrid& map, const maps::OccupancyGrid& reference);
/// Cells missed: "3 of 9159".
std::string text_of(const Coverage& seen);

/// Cells that are known in both and free in one and occupied in the other, as a part of those known in both.
double disagreement(const maps::OccupancyGrid& map, const maps::OccupancyGrid& reference);

}  // namespace sf::scenarios
