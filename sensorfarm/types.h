#pragma once
// Plain types of the public interface: metres, radians, seconds. Headers of this folder include only the standard
// library.

#include <cstdint>

#define SENSORFARM_API __attribute__((visibility("default")))

namespace sensorfarm {

/// A planar pose with a height, in the world frame unless stated otherwise: x forward, y left, z up.
struct Pose {
  double x = 0.0;    ///< [m]
  double y = 0.0;    ///< [m]
  double z = 0.0;    ///< [m]
  double yaw = 0.0;  ///< [rad] counter-clockwise, unbounded
};

/// A velocity in the robot's own frame.
struct Twist {
  double forward = 0.0;  ///< [m/s] along the robot's x
  double left = 0.0;     ///< [m/s] along the robot's y; 0 for robots that cannot move sideways
  double turn = 0.0;     ///< [rad/s] counter-clockwise
};

inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;   ///< no id; as a hit: the beam met nothing within range
inline constexpr std::uint32_t kFloor = 0xFFFFFFFEu;  ///< as a hit: a tilted beam met the floor or a road

}  // namespace sensorfarm
