#pragma once
// Passing a slower robot: over to the lane beside, past it, and back.

#include <optional>

#include "control/robots_ahead.h"

namespace sf::control {

/// A route that passes the robot ahead and comes back to the lane, or nothing where the lane beside is taken, or too
/// short. `plan` is on a lane at `s`.
/// @param speed [m/s] of the passing robot
struct Passing {
  RoutePlan plan;
  double until = 0.0;  ///< [m] along it: back in its lane
};
std::optional<Passing> plan_passing(const LaneCorridors& corridors, const RoutePlan& plan, double s, double speed,
                                    const LeadRobot& slow, const std::vector<RoadUser>& road_users);

/// The way leads from a lane to another one of the same segment in its course.
bool changes_lanes(const LaneCorridors& corridors, std::uint32_t way);

/// Gives up a change of lanes: a route from where the robot is back into the lane that it was to leave, to that lane's
/// next point, without what was to come and without the goals after `s`. `plan` is on a way that changes lanes at `s`.
/// Nothing where the lane to be entered is nearer already.
std::optional<RoutePlan> plan_return(const LaneCorridors& corridors, const RoutePlan& plan, double s, const Pose& X_WM);

}  // namespace sf::control
