#pragma once
// Builds a map of a recorded run from the scans of all lasers, with the update rule of the robots' maps
// (maps/grid_update.h).
//
// One hit weighs as much as eight scans that pass: a wall persists although beams graze it, and an obstacle that was
// removed disappears.

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "base/reading.h"
#include "base/rigid_transform.h"
#include "maps/grid_update.h"
#include "sensors/sensor_type.h"
#include "world/world.h"

namespace sf::viz {

/// Returns a grid over the extent with cells of whole centimetres, fine enough to show walls and coarse enough for a
/// page.
maps::GridGeometry grid_over(const world::Extent& extent);

/// Not thread-safe. Allocates nothing after the first scans.
class ScanMap {
 public:
  explicit ScanMap(const maps::GridGeometry& geometry);

  /// Adds a noise-free scan of `laser`, which is in this world, seen from above. A beam that ends on a mover, the floor
  /// or terrain frees its cells. A range beyond maps::kMaxRangeCells cells has no echo. An echo counts half a cell
  /// behind its range: the wall then gets a cell that is mostly solid, regardless of rounding, and lines of cells,
  /// which deviate up to half a cell from their beams, free no cell behind it.
  /// @param X_MS pose of the laser in the robot's frame (sensors::laser_mount)
  void add(const world::World& world, const sensors::SensorSpec& laser, const base::RigidTransform& X_MS,
           const base::ReadingBlock& scan);
  maps::OccupancyGrid states() const { return maps::to_occupancy(odds_); }

 private:
  base::Pose project(const sensors::SensorSpec& laser, const base::RigidTransform& X_WS,
                     std::span<const glm::dvec2> beams);

  maps::LogOddsGrid odds_;
  std::map<std::pair<double, std::uint32_t>, std::vector<glm::dvec2>> beams_;  ///< by field of view and samples
  std::vector<glm::dvec2> projected_;                                          ///< beams of a tilted scan
  std::vector<double> ranges_;
  std::vector<std::uint32_t> ends_;
};

}  // namespace sf::viz
