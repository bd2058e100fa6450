#pragma once
// Distinguishes driving from teleporting, given two poses of a mover.

#include <cmath>

#include "base/elementary.h"
#include "base/pose.h"

namespace sf::base {

/// Returns true when a mover may have driven from one pose to the other: the distance is at most 0.5 m plus twice the
/// distance covered at top speed.
/// @param max_speed [m/s], may be infinite  @param seconds >= 0, time between the poses
inline bool is_drivable(const Pose& from, const Pose& to, double max_speed, double seconds) {
  constexpr double kAlways = 0.5;  // [m]
  return !(hypot(to.x - from.x, to.y - from.y) > kAlways + 2.0 * max_speed * seconds);
}

}  // namespace sf::base
