#pragma once
// Where a robot is to go: a list of checkpoints, once or round and round, or checkpoints drawn by lot for ever.

#include <vector>

#include "control/controllers.h"
#include "world/roads/network.h"

namespace sf::control {

class RouteGoals {
 public:
  /// Reads `checkpoints [1 2]`, `mission "file.mdf"`, `park "zone.spot"`, `tour true` (by lot), `loop true`.
  /// @throws base::InputError where they name what the network does not have, or nothing at all.
  RouteGoals(const ControllerContext& context, Settings& settings);
  /// By lot; none where the network has no checkpoints on lanes.
  explicit RouteGoals(const ControllerContext& context);

  /// Goal `k`, 0-based; null: there are no more.
  const world::RoadCheckpoint* at(std::uint64_t k) const;
  bool by_lot() const { return tour_; }
  /// Goals that come before all repeats; 0 by lot.
  std::size_t count() const { return goals_.size(); }
  /// The highest speed on a lane of this segment, or a zone. [m/s]
  double limit(std::uint32_t segment) const { return segment < limits_.size() ? limits_[segment] : HUGE_VAL; }

 private:
  void draw_from(const world::RoadNetwork& roads);
  void read_mission(const ControllerContext& context, const std::string& file);
  void read_park(const ControllerContext& context, Settings& settings);

  std::vector<world::RoadCheckpoint> goals_;
  std::vector<world::RoadCheckpoint> lots_;  ///< those on lanes
  std::vector<double> limits_;               ///< by row of `RoadNetwork::segments`
  bool loop_ = false, tour_ = false;
  std::uint64_t seed_ = 0;
  std::uint32_t robot_ = 0;
};

}  // namespace sf::control
