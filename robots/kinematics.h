#pragma once
// Kinematics of drives: the nearest feasible twist, and the pose after a constant twist. Limits are those of the robot
// type: `velocity_bounds` in its world file (worlds/robots.inc; key: world/fields.h).

#include <cstdint>

#include "base/pose.h"
#include "base/report.h"
#include "world/world.h"

namespace sf::robots {

/// [rad] steering limit of a car.
inline constexpr double kMaxSteer = M_PI / 6.0;

inline bool moves(const base::Twist& v) { return v.forward != 0.0 || v.left != 0.0 || v.turn != 0.0; }

/// Returns `twist` with NaN and infinity replaced by 0.
base::Twist finite(const base::Twist& twist);

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

/// Returns the pose of a frame after `dt` [s] with the constant body twist `velocity`: exact, along an arc. The yaw is
/// in [-pi, pi].
base::Pose advance(const base::Pose& X_WM, const base::Twist& velocity, double dt);

/// [ns] Longest time by which a report is extrapolated with its velocity.
inline constexpr std::int64_t kMaxExtrapolation = 500'000'000;

/// Returns the state at `time` [ns] with the constant twist of `known`, extrapolated by at most kMaxExtrapolation and
/// never backwards.
base::Report extrapolate(const base::Report& known, std::int64_t time);

/// Returns the state of a mover at `time`, between two of its states. Follows the arc of the later velocity if it
/// connects the two poses, which holds unless the mover was stopped; otherwise follows the arc of constant twist
/// between the poses, by the smaller turn. Contacts are those of `before`. Pure function.
/// @param time [ns] in [before.time, after.time); before.time < after.time
base::Report interpolate(const base::Report& before, const base::Report& after, std::int64_t time);

}  // namespace sf::robots
