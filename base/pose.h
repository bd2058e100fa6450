#pragma once
// Planar poses with a height: the frames of a 2.5-D world.

#include <cmath>

namespace sf::base {

/// A point or a direction in a plane. [m] when it is a point.
struct Vec2 {
  double x = 0.0;
  double y = 0.0;
};

/// Frame B in frame A (`X_AB`): rotate by `yaw` about +z, then translate. Right-handed, x forward, y left.
struct Pose {
  double x = 0.0;    ///< [m]
  double y = 0.0;    ///< [m]
  double z = 0.0;    ///< [m] height of the origin of B above the origin of A
  double yaw = 0.0;  ///< [rad] counter-clockwise, any value
};

/// Body-frame velocity.
struct Twist {
  double forward = 0.0;  ///< [m/s] along the robot's x
  double left = 0.0;     ///< [m/s] along the robot's y
  double turn = 0.0;     ///< [rad/s] counter-clockwise
};

inline Vec2 operator+(Vec2 p, Vec2 q) { return {p.x + q.x, p.y + q.y}; }
inline Vec2 operator-(Vec2 p, Vec2 q) { return {p.x - q.x, p.y - q.y}; }
inline Vec2 operator*(double s, Vec2 p) { return {s * p.x, s * p.y}; }
inline double dot(Vec2 p, Vec2 q) { return p.x * q.x + p.y * q.y; }
inline double cross(Vec2 p, Vec2 q) { return p.x * q.y - p.y * q.x; }
inline double length(Vec2 p) { return std::sqrt(p.x * p.x + p.y * p.y); }

inline Vec2 rotate(double yaw, Vec2 p) {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

/// X_AC from X_AB and X_BC.
inline Pose compose(const Pose& X_AB, const Pose& X_BC) {
  const Vec2 p = rotate(X_AB.yaw, {X_BC.x, X_BC.y});
  return {X_AB.x + p.x, X_AB.y + p.y, X_AB.z + X_BC.z, X_AB.yaw + X_BC.yaw};
}

/// Point `p_B` expressed in A.
inline Vec2 transform(const Pose& X_AB, Vec2 p_B) { return Vec2{X_AB.x, X_AB.y} + rotate(X_AB.yaw, p_B); }

/// The same heading in [-pi, pi].
inline double wrap_angle(double angle) {
  if (std::abs(angle) <= M_PI) return angle;
  // For a million radians and more, 2 pi in 64 bits is too far from 2 pi.
  return std::abs(angle) < 1e6 ? std::remainder(angle, 2.0 * M_PI) : std::atan2(std::sin(angle), std::cos(angle));
}

}  // namespace sf::base
