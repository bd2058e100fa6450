#pragma once
// Map coverage of a robot: compares its map with a reference computed from the true walls.

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/reading.h"
#include "maps/grid.h"
#include "sensors/sensor_type.h"
#include "world/world.h"

namespace sf::scenarios {

/// The map of one robot, built from the scans of one of its lasers at their reported poses.
class RobotMap {
 public:
  /// Uses the grid of the explorer (control/explore.h), or one over the world's extent if the area is too large for
  /// that. Enlarges cells if the map would have more than 4.2 million of them.
  /// @param laser of the robot  @param cell [m]
  RobotMap(const world::World& world, const sensors::SensorSpec& laser, double cell = 0.03);
  /// Adds the reading if it is a scan of this laser.
  void add(const base::ReadingBlock& reading);
  const maps::OccupancyGrid& grid() const { return grid_; }

 private:
  std::uint32_t mover_, laser_;
  maps::OccupancyGrid grid_;
  std::vector<glm::dvec2> beams_;
  double range_min_ = 0.0, range_max_ = 0.0;  ///< [m]
  std::vector<double> ranges_;                ///< [m] of the last scan with quality flags
};

/// Adds each scan to the map of its mover, if present.
/// @param maps by row of the mover
void add_scans(std::span<const base::ReadingBlock> readings, std::map<std::uint32_t, RobotMap>& maps);

/// The free cells of a reference, and how many of them are unexplored in a map.
struct Coverage {
  std::size_t wanted = 0;
  std::size_t missed = 0;  ///< <= wanted
  /// [-] 1 only if no cell is missed.
  double coverage() const {
    return wanted == 0 ? 1.0 : static_cast<double>(wanted - missed) / static_cast<double>(wanted);
  }
};
/// @pre both have the same geometry
Coverage coverage_of(const maps::OccupancyGrid& map, const maps::OccupancyGrid& reference);
/// Returns the missed and wanted cells, such as "3 of 9159".
std::string coverage_text(const Coverage& seen);

/// [-] Fraction of the cells known in both maps that are free in one and occupied in the other.
double disagreement(const maps::OccupancyGrid& map, const maps::OccupancyGrid& reference);

}  // namespace sf::scenarios
