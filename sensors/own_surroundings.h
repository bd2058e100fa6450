#pragma once
// Queries of users' own sensors about their surroundings.

#include <cstdint>
#include <span>
#include <vector>

#include "base/reading.h"
#include "raycast/intersect.h"
#include "raycast/sensor_context.h"
#include "robots/neighbour_grid.h"
#include "sensorfarm/sensor.h"
#include "world/wall_tree.h"

namespace sf::sensors {

/// Walls and robots of one tick. Queries may run on any thread, but not during `place_movers`.
class OwnSurroundings {
 public:
  explicit OwnSurroundings(const raycast::SensorContext& context);

  /// Indexes the robots at their poses.
  void place_movers();
  /// See sensorfarm::Surroundings::cast. @param self row of the robot that the ray ignores
  sensorfarm::Hit cast(std::uint32_t self, const base::Pose& from, double range) const;
  /// Returns the states of the movers of the world of `mover`.
  std::span<const base::Report> states_with(std::uint32_t mover) const {
    const auto [first, end] = copies_.rows_with(mover, static_cast<std::uint32_t>(states_.size()));
    return states_.subspan(first, end - first);
  }

 private:
  struct Nearest;
  void meet_walls(Nearest& nearest, double from, double to) const;
  void meet_movers(Nearest& nearest) const;

  const world::World& world_;
  world::CopyIndex copies_;
  std::span<const base::Report> states_;
  world::WallTree walls_;  ///< walls that lasers detect
  robots::NeighbourGrid grid_;
  double largest_ = 0.0;  ///< [m] largest radius of a robot
};

}  // namespace sf::sensors
