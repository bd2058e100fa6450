#pragma once
// Limits of a robot's motion: the nearest feasible twist. Speeds and accelerations are those of the robot type:
// `velocity_bounds` and `acceleration_bounds` in its world file (worlds/robots.inc; keys: world/fields.h).

#include "base/pose.h"
#include "world/world.h"

namespace sf::robots {

/// [rad] steering limit of a car.
inline constexpr double kMaxSteer = M_PI / 6.0;

/// Returns the nearest twist within the limits of the mover's drive. NaN and infinity become 0.
/// - all drives: |turn| <= max_turn.
/// - differential, skid: left = 0, |forward| <= max_forward. The scrub of a skid drive's wheels affects the track that
///   its encoders measure (`Mover::track`), not its path.
/// - omni: speed <= max_forward, direction kept.
/// - car (kinematic bicycle): as differential, and |turn| <= |forward| tan(kMaxSteer) / wheelbase, so it cannot turn in
///   place.
base::Twist limit_kinematics(const world::Mover& mover, const base::Twist& command);

/// Returns the twist after accelerating from `now` towards `wanted` for `dt` [s] > 0. The mover's accelerations bound
/// the length of the velocity change (for all drives) and the change of turn, when speeding up and slowing down. The
/// result is exactly `wanted` if it is within reach. `limit_kinematics` is applied afterwards.
/// @param wanted a result of `limit_kinematics`
base::Twist limit_acceleration(const world::Mover& mover, const base::Twist& now, const base::Twist& wanted, double dt);

}  // namespace sf::robots
