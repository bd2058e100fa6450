#pragma once
// How drives move: the twist a drive can follow, and where a constant twist leads.

#include "base/pose.h"
#include "world/world.h"

namespace sf::robots {

/// Steering limit of a car. [rad]
inline constexpr double kMaxSteer = M_PI / 6.0;

/// The nearest twist the mover's drive can follow. Numbers that are not finite become 0.
/// - |turn| <= max_turn always.
/// - differential: left = 0, |forward| <= max_forward.
/// - omni: the velocity's length <= max_forward, direction kept.
/// - car (kinematic bicycle): as differential, and |turn| <= |forward| tan(kMaxSteer) / wheelbase: it cannot turn in
/// place.
base::Twist follow(const world::Mover& mover, const base::Twist& command);

/// Where a frame that moves with the constant body twist `velocity` is after `dt` [s]: exactly, along an arc.
/// The yaw of the result is wrapped to [-pi, pi].
base::Pose advance(const base::Pose& X_WM, const base::Twist& velocity, double dt);

}  // namespace sf::robots
