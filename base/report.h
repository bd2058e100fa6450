#pragma once
// States of movers from any source: a simulated robot, a V2V packet or a TAG packet of an overhead camera.

#include <cmath>
#include <cstdint>

#include "base/pose.h"

namespace sf::base {

/// Speeds of the rims of a mover's left and right wheels on average since the last tick, forward positive.
struct WheelSpeeds {
  float left = NAN, right = NAN;  ///< [m/s] NaN: not known; the wheels roll with the ground
  bool are_known() const { return !std::isnan(left); }
};

/// State of one mover at one time.
struct Report {
  std::uint32_t mover = 0;         ///< row in `world::World::movers`
  std::int64_t time = 0;           ///< [ns] simulated time (or the sender's clock) at which the state was valid
  Pose X_WM;                       ///< the mover's frame in the world; finite, or kAbsent
  Twist velocity;                  ///< in the mover's frame; zero if unknown
  Tilt tilt;                       ///< of the mover, for its spatial sensors; finite
  std::uint32_t contact_mask = 0;  ///< bit k: the body is touched in sector k, see kContactSectors
  WheelSpeeds wheels;              ///< of simulated cars, for their encoders
};

/// Pose of an absent mover, which no sensor detects. Never reported from outside.
inline constexpr Pose kAbsent{NAN, NAN, NAN, NAN};
inline bool is_absent(const Pose& X_WM) { return std::isnan(X_WM.x); }

/// Sector k of a body covers the bearings from k to k + 1 times 2 pi / kContactSectors, counter-clockwise from the
/// body's x axis.
inline constexpr std::uint32_t kContactSectors = 32;

inline constexpr std::uint32_t kNoId = 0xFFFFFFFFu;

/// The robot's intent, carried by a V2V packet in addition to the state.
struct Intent {
  std::uint32_t follows = kNoId;     ///< id of the robot that it follows
  std::uint32_t checkpoint = kNoId;  ///< id of the checkpoint that it is heading for
  bool docking = false;
};

}  // namespace sf::base
