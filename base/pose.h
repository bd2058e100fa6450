#pragma once
// Planar poses with a height: the frames of a 2.5-D world.

#include <cmath>
#include <glm/ext/vector_double2.hpp>
#include <glm/ext/vector_double3.hpp>
#include <glm/geometric.hpp>

#include "base/elementary.h"

#ifndef GLM_FORCE_CTOR_INIT
#error "GLM_FORCE_CTOR_INIT must be defined: vectors of this project start at zero"
#endif

namespace sf::base {

/// Pose of frame B in frame A (`X_AB`): rotate by `yaw` about +z, then translate. Right-handed, x forward, y left.
struct Pose {
  double x = 0.0;    ///< [m]
  double y = 0.0;    ///< [m]
  double z = 0.0;    ///< [m] height of the origin of B above the origin of A
  double yaw = 0.0;  ///< [rad] counter-clockwise, any value
};

/// Rotation of a body against its planar pose: Rz(yaw) Ry(pitch) Rx(roll) is its orientation.
struct Tilt {
  double roll = 0.0;   ///< [rad] positive: the left side is higher
  double pitch = 0.0;  ///< [rad] positive: the front is lower
};

/// Velocity in the body frame.
struct Twist {
  double forward = 0.0;  ///< [m/s] along the robot's x
  double left = 0.0;     ///< [m/s] along the robot's y
  double turn = 0.0;     ///< [rad/s] counter-clockwise
};

/// Returns the unit vector of a heading [rad].
inline glm::dvec2 direction(double yaw) {
  const auto [s, c] = sin_cos(yaw);
  return {c, s};
}

/// Returns z of the cross product: twice the area of the triangle (0, p, q), positive when q is to the left of p.
inline double cross(glm::dvec2 p, glm::dvec2 q) { return p.x * q.y - p.y * q.x; }

inline glm::dvec2 rotate(double yaw, glm::dvec2 p) {
  const auto [s, c] = sin_cos(yaw);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

/// Returns X_AC from X_AB and X_BC.
inline Pose compose(const Pose& X_AB, const Pose& X_BC) {
  const glm::dvec2 p = rotate(X_AB.yaw, {X_BC.x, X_BC.y});
  return {X_AB.x + p.x, X_AB.y + p.y, X_AB.z + X_BC.z, X_AB.yaw + X_BC.yaw};
}

/// Returns X_BA from X_AB.
inline Pose inverse(const Pose& X_AB) {
  const glm::dvec2 p = rotate(-X_AB.yaw, {-X_AB.x, -X_AB.y});
  return {p.x, p.y, -X_AB.z, -X_AB.yaw};
}

/// Returns point `p_B` expressed in A.
inline glm::dvec2 transform(const Pose& X_AB, glm::dvec2 p_B) {
  return glm::dvec2{X_AB.x, X_AB.y} + rotate(X_AB.yaw, p_B);
}

/// Returns the same heading in [-pi, pi].
inline double wrap_angle(double angle) {
  if (std::abs(angle) <= M_PI) return angle;
  if (std::abs(angle) < 1e6) return std::remainder(angle, 2.0 * M_PI);
  // The rounding error of 2 pi times the number of turns is too large.
  const auto [s, c] = sin_cos(angle);
  return atan2(s, c);
}

}  // namespace sf::base
