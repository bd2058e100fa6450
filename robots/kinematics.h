#pragma once
// Kinematics of drives: the nearest twist that a drive can follow, and the pose after a constant twist. Limits are the
// robot type's: `velocity_bounds` in its world file (worlds/robots.inc, world/stage/mover_entities.cpp).

#include <cstdint>

#include "base/pose.h"
#include "base/report.h"
#include "world/world.h"

namespace sf::robots {

/// Steering limit of a car. [rad]
inline constexpr double kMaxSteer = M_PI / 6.0;

/// The nearest twist the mover's drive can follow. Numbers that are not finite become 0.
/// - |turn| <= max_turn always.
/// - differential, skid: left = 0, |forward| <= max_forward. A skid drive's wheels scrub; that is a matter of the track
///   its encoders see (`Mover::track`), not of where it goes.
/// - omni: the velocity's length <= max_forward, direction kept.
/// - car (kinematic bicycle): as differential, and |turn| <= |forward| tan(kMaxSteer) / wheelbase: it cannot turn in
/// place.
base::Twist limit_kinematics(const world::Mover& mover, const base::Twist& command);

/// The twist after `dt` [s] > 0 on the way from `now` to `wanted`: both its velocity (its length, for all drives) and
/// its turn change by no more than the mover's accelerations allow, whether it speeds up or slows down; `wanted`
/// exactly where they allow it. Then `limit_kinematics`.
/// @param wanted as `limit_kinematics` gives it
base::Twist limit_acceleration(const world::Mover& mover, const base::Twist& now, const base::Twist& wanted, double dt);

/// Where a frame that moves with the constant body twist `velocity` is after `dt` [s]: exactly, along an arc.
/// The yaw of the result is wrapped to [-pi, pi].
base::Pose advance(const base::Pose& X_WM, const base::Twist& velocity, double dt);

/// One mover at `time`, between the times of two of its states: on the arc that the later velocity leads along where it
/// leads from one pose to the other, which is how a mover moves that nothing stops; else on the arc of constant twist
/// between the poses, by the lesser turn. What touches it is as before. A function of the two states alone.
/// @param time [ns] in [before.time, after.time), which are not the same
base::Report interpolate(const base::Report& before, const base::Report& after, std::int64_t time);

}  // namespace sf::robots
