#pragma once
// Displacements between two known poses: driven, or put elsewhere.

#include <cmath>

#include "base/pose.h"

namespace sf::base {

/// A mover may have driven from one pose to the other: they are at most 0.5 m plus twice the way at top speed apart.
/// @param max_speed [m/s], may be infinite  @param seconds >= 0 between the poses
inline bool is_drivable(const Pose& from, const Pose& to, double max_speed, double seconds) {
  constexpr double kAlways = 0.5;  // [m]
  return !(std::hypot(to.x - from.x, to.y - from.y) > kAlways + 2.0 * max_speed * seconds);
}

}  // namespace sf::base
