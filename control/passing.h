#pragma once
// Passing a slower robot: over to the lane beside, past it, and back.

#include <optional>

#include "control/route_ahead.h"

namespace sf::control {

/// A route that passes the robot ahead and comes back to the lane, or nothing where the lane beside is taken, or too
/// short. `plan` is on a lane at `s`.
/// @param speed [m/s] of the passing robot
struct Passing {
  RoutePlan plan;
  double until = 0.0;  ///< [m] along it: back in its lane
};
std::optional<Passing> plan_passing(const Corridors& corridors, const RoutePlan& plan, double s, double speed,
                                    const Ahead& slow, const std::vector<Driver>& drivers);

}  // namespace sf::control
