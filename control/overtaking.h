#pragma once
// Overtaking: changes to the adjacent lane, passes the slower robot, and changes back.

#include <optional>

#include "control/robots_ahead.h"

namespace sf::control {

/// A route that overtakes the robot ahead and returns to the lane; nullopt if the adjacent lane is occupied or too
/// short. @pre `plan` is on a lane at `s`
/// @param speed [m/s] of the overtaking robot
struct Passing {
  RoutePlan plan;
  double until = 0.0;  ///< [m] along the plan, where the robot is back in its lane
};
std::optional<Passing> plan_passing(const LaneCorridors& corridors, const RoutePlan& plan, double s, double speed,
                                    const LeadRobot& slow, const std::vector<RoadUser>& road_users);

/// Returns whether the way leads from a lane to another lane of the same segment, before the end of the first.
bool changes_lanes(const LaneCorridors& corridors, std::uint32_t way);

/// Aborts a lane change: returns a route from the robot's position back to the lane that it was leaving, to that lane's
/// next point. Drops the remaining legs and the goals after `s`. @pre `plan` is on a lane change at `s`. Returns
/// nullopt if the lane to be entered is already nearer.
std::optional<RoutePlan> plan_return(const LaneCorridors& corridors, const RoutePlan& plan, double s, const Pose& X_WM);

}  // namespace sf::control
