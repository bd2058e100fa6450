#pragma once
// Goals of a route: a list of checkpoints, once or repeated, or an endless sequence of random checkpoints.

#include <vector>

#include "control/controllers.h"
#include "world/roads/network.h"

namespace sf::control {

class RouteGoals {
 public:
  /// Reads `checkpoints [1 2]`, `mission "file.mdf"`, `park "zone.spot"`, `tour true` (random), `loop true`.
  /// @throws base::InputError for a name that the network does not have, or if the settings contain no goal
  RouteGoals(const ControllerContext& context, Settings& settings);
  /// Draws random goals; there are none if the network has no checkpoints on lanes.
  explicit RouteGoals(const ControllerContext& context);

  /// Returns goal `k`, 0-based; null after the last one.
  const world::RoadCheckpoint* at(std::uint64_t k) const;
  bool by_lot() const { return tour_; }
  /// Returns the number of goals of one repetition; 0 for random goals.
  std::size_t count() const { return goals_.size(); }
  /// Returns the speed limit [m/s] of the mission on a lane of this segment, or in a zone; infinity without a limit.
  double limit(std::uint32_t segment) const { return segment < limits_.size() ? limits_[segment] : HUGE_VAL; }

 private:
  void draw_from(const world::RoadNetwork& roads);
  void read_mission(const ControllerContext& context, const std::string& file);
  void read_park(const ControllerContext& context, Settings& settings);

  std::vector<world::RoadCheckpoint> goals_;
  std::vector<world::RoadCheckpoint> lots_;  ///< candidates for random goals: checkpoints on lanes
  std::vector<double> limits_;               ///< [m/s] by row of `RoadNetwork::segments`
  bool loop_ = false, tour_ = false;
  std::uint64_t seed_ = 0;
  std::uint32_t robot_ = 0;
};

}  // namespace sf::control
