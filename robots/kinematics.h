#pragma once
// Kinematics of planar bodies: the pose after a constant twist, and states between and after reported ones.

#include <cstdint>
#include <glm/ext/vector_double3.hpp>

#include "base/pose.h"
#include "base/report.h"
#include "base/tilted_pose.h"
#include "world/world.h"

namespace sf::robots {

inline bool moves(const base::Twist& v) { return v.forward != 0.0 || v.left != 0.0 || v.turn != 0.0; }

/// Returns `twist` with NaN and infinity replaced by 0.
base::Twist finite(const base::Twist& twist);

/// Returns the pose of a frame after `dt` [s] with the constant body twist `velocity`: exact, along an arc. The yaw is
/// in [-pi, pi].
base::Pose advance(const base::Pose& X_WM, const base::Twist& velocity, double dt);

/// Returns the constant twist from one pose to another in `seconds` > 0, by the smaller turn: the inverse of `advance`.
base::Twist twist_between(const base::Pose& from, const base::Pose& to, double seconds);

/// [ns] Longest time by which a report is extrapolated with its velocity.
inline constexpr std::int64_t kMaxExtrapolation = 500'000'000;

/// Returns the state at `time` [ns] with the constant twist, height and tilt of `known`, extrapolated by at most
/// kMaxExtrapolation and never backwards.
base::Report extrapolate(const base::Report& known, std::int64_t time);

/// Returns the state of a mover at `time`, between two of its states. Follows the arc of the later velocity if it
/// connects the two poses, which holds unless the mover was stopped; otherwise follows the arc of constant twist
/// between the poses, by the smaller turn. Level movers keep their height until `after`. Movers that are tilted before
/// or after follow the screw motion between the two poses (base::screw_between), with the planar velocity of level
/// movers. Contacts are those of `before`. Pure function.
/// @param time [ns] in [before.time, after.time); before.time < after.time
base::Report interpolate(const base::Report& before, const base::Report& after, std::int64_t time);

/// Returns the constant velocity of a mover between two of its states, in its own frame, by the motion that
/// `interpolate` follows. Level movers have no vertical velocity, since their height changes at ticks.
base::BodyVelocity velocity_between(const base::Report& before, const base::Report& after);

/// Velocity of a mover in the world's axes.
struct WorldVelocity {
  glm::dvec3 linear{};   ///< [m/s] of its origin
  glm::dvec3 angular{};  ///< [rad/s]
};

/// Returns the velocity that a state has by its planar twist: a tilted body moves along the plane that it is parallel
/// to, as on a slope, and turns about its upright axis.
WorldVelocity velocity_on_slope(const base::Report& state);

}  // namespace sf::robots
