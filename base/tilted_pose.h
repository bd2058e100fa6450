#pragma once
// Planar poses with tilt: as quaternions, and on the way from one to another.

#include "base/pose.h"
#include "base/rigid_transform.h"

namespace sf::base {

/// Pose in six degrees of freedom: a planar pose whose body is tilted about its origin.
struct TiltedPose {
  Pose X;
  Tilt tilt;
};
inline bool is_level(const Tilt& tilt) { return tilt.roll == 0.0 && tilt.pitch == 0.0; }

/// Inverse of `transform_of`, to rounding: yaw and roll in [-pi, pi], pitch in [-pi/2, pi/2]. Where the x axis is
/// vertical, rounding decides how the turn is divided between yaw and roll; together they are the rotation there, too.
TiltedPose tilted_pose_of(const RigidTransform& X_AB);

/// Rotation w + x i + y j + z k. q and -q are the same rotation.
struct Quaternion {
  double w = 1.0, x = 0.0, y = 0.0, z = 0.0;
};

/// Returns the unit quaternion of Rz(yaw) Ry(pitch) Rx(roll). Without tilt, x and y are exactly 0.
Quaternion quaternion_of(double yaw, const Tilt& tilt);

/// @param q of any norm above 0
glm::dmat3 rotation_of(const Quaternion& q);

/// Returns the pose at `part` in [0, 1] of the screw motion from one pose to another by the smaller turn, in which the
/// linear and the angular velocity are constant in the body's frame. Between level poses of one height it is the arc of
/// constant twist.
TiltedPose screw_between(const TiltedPose& from, const TiltedPose& to, double part);

/// Velocity of a frame, in that frame.
struct BodyVelocity {
  glm::dvec3 linear{};   ///< [m/s] of its origin
  glm::dvec3 angular{};  ///< [rad/s]
};

/// Returns the constant velocity of that motion, which takes `seconds` > 0.
BodyVelocity screw_velocity(const TiltedPose& from, const TiltedPose& to, double seconds);

}  // namespace sf::base
