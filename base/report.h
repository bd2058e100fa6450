#pragma once
// The state of movers, from any source: a simulated robot, a V2V packet or a TAG packet of an overhead camera.

#include <cmath>
#include <cstdint>

#include "base/pose.h"

namespace sf::base {

/// The state of one mover at one time.
struct Report {
  std::uint32_t mover = 0;         ///< row in `world::World::movers`
  std::int64_t time = 0;           ///< [ns] simulated time (or the sender's clock) at which the state was true
  Pose X_WM;                       ///< the mover's frame in the world; finite, or kAbsent
  Twist velocity;                  ///< in the mover's frame; zero where unknown
  std::uint32_t contact_mask = 0;  ///< bit k: something touches the body in sector k, see kContactSectors
};

/// The pose of an absent mover, which nothing senses. Never reported from outside.
inline constexpr Pose kAbsent{NAN, NAN, NAN, NAN};
inline bool is_absent(const Pose& X_WM) { return std::isnan(X_WM.x); }

/// Sector k of a body covers the bearings from k to k + 1 times 2 pi / kContactSectors, counter-clockwise from the
/// body's x axis.
inline constexpr std::uint32_t kContactSectors = 32;

inline constexpr std::uint32_t kNoId = 0xFFFFFFFFu;

/// The part of a V2V packet beside the state: the robot's intent.
struct Intent {
  std::uint32_t follows = kNoId;     ///< id of the robot it follows
  std::uint32_t checkpoint = kNoId;  ///< id of the checkpoint it heads for
  bool docking = false;
};

}  // namespace sf::base
