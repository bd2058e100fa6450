#pragma once
// What a mover says of itself, whoever says it: a simulated robot, a V2V packet, an overhead camera's tag.

#include <cstdint>

#include "base/pose.h"

namespace sf::base {

/// The state of one mover at one time.
struct Report {
  std::uint32_t mover = 0;  ///< row in `world::World::movers`
  std::int64_t time = 0;    ///< [ns] simulated time (or the sender's clock) at which the state was true
  Pose X_WM;                ///< the mover's frame in the world; finite
  Twist velocity;           ///< in the mover's own frame; zero where unknown
};

}  // namespace sf::base
