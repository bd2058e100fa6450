#pragma once
// Kinematics of drives: the nearest twist that a drive can follow, and the pose after a constant twist. Limits are the
// robot type's: `velocity_bounds` in its world file (worlds/robots.inc; key: world/fields.h).

#include <cstdint>

#include "base/pose.h"
#include "base/report.h"
#include "world/world.h"

namespace sf::robots {

/// [rad] steering limit of a car.
inline constexpr double kMaxSteer = M_PI / 6.0;

inline bool moves(const base::Twist& v) { return v.forward != 0.0 || v.left != 0.0 || v.turn != 0.0; }

/// `twist` with 0 for NaN and infinity.
base::Twist finite(const base::Twist& twist);

/// The nearest twist within the limits of the mover's drive. NaN and infinity become 0.
/// - all drives: |turn| <= max_turn.
/// - differential, skid: left = 0, |forward| <= max_forward. The scrub of a skid drive's wheels affects the track that
///   its encoders measure (`Mover::track`), not its path.
/// - omni: the velocity's length <= max_forward, direction kept.
/// - car (kinematic bicycle): as differential, and |turn| <= |forward| tan(kMaxSteer) / wheelbase: no turn in place.
base::Twist limit_kinematics(const world::Mover& mover, const base::Twist& command);

/// The twist after `dt` [s] > 0 of acceleration from `now` towards `wanted`. The length of the velocity change (for all
/// drives) and the change of turn are bounded by the mover's accelerations, for acceleration and deceleration; the
/// result is `wanted` exactly when it is in reach. Then `limit_kinematics`.
/// @param wanted a result of `limit_kinematics`
base::Twist limit_acceleration(const world::Mover& mover, const base::Twist& now, const base::Twist& wanted, double dt);

/// Pose of a frame after `dt` [s] with the constant body twist `velocity`: exact, along an arc. The yaw of the result
/// is in [-pi, pi].
base::Pose advance(const base::Pose& X_WM, const base::Twist& velocity, double dt);

/// [ns] longest extrapolation of a report with its velocity.
inline constexpr std::int64_t kMaxExtrapolation = 500'000'000;

/// The state after `known` with its constant twist: at `time` [ns], or as far as kMaxExtrapolation reaches. Never
/// earlier than `known`.
base::Report extrapolate(const base::Report& known, std::int64_t time);

/// State of one mover at `time`, between two of its states: on the arc of the later velocity when it connects the two
/// poses, which holds for a mover that nothing stopped; else on the arc of constant twist between the poses, by the
/// smaller turn. Contacts are those of `before`. A function of the two states alone.
/// @param time [ns] in [before.time, after.time); before.time < after.time
base::Report interpolate(const base::Report& before, const base::Report& after, std::int64_t time);

}  // namespace sf::robots
