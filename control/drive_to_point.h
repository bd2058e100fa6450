#pragma once
// Drives to a point: turns in place first, then drives forward.

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/pose.h"

namespace sf::control {

struct DriveLimits {
  double speed = 0.1;  ///< [m/s]
  double turn = 1.0;   ///< [rad/s] maximum
  double aim = 0.3;    ///< [rad] a larger heading error allows only a turn
  double gain = 3.0;   ///< [1/s] turn rate per heading error
};

/// @return turn rate [rad/s]
inline double turn_to(double heading_error, const DriveLimits& pace) {
  return std::clamp(pace.gain * heading_error, -pace.turn, pace.turn);
}

inline base::Twist drive_to_point(const base::Pose& X_WM, glm::dvec2 p, const DriveLimits& pace) {
  const glm::dvec2 d{p.x - X_WM.x, p.y - X_WM.y};
  const double off = base::wrap_angle(base::atan2(d.y, d.x) - X_WM.yaw);
  return {std::abs(off) <= pace.aim ? pace.speed : 0.0, 0.0, turn_to(off, pace)};
}

}  // namespace sf::control
