#pragma once
// How far a mover's state can be relied on: a reading is as good as the state that it was computed from.

#include <array>
#include <cstdint>
#include <limits>

namespace sf::base {

/// Age where no state has arrived yet: the mover is where the world file places it.
inline constexpr std::int64_t kNoStateYet = std::numeric_limits<std::int64_t>::max();

struct StateQuality {
  bool stated = false;   ///< false: nothing is known; the other members are 0 and false
  bool stale = false;    ///< the state is too old to be relied on
  std::int64_t age = 0;  ///< [ns] of the state when it was used, rounded up to 1000 in a packet; or kNoStateYet
  std::array<float, 6> covariance{};  ///< of x, y [m], yaw [rad]: xx, xy, x yaw, yy, y yaw, yaw yaw; 0: not known
};

}  // namespace sf::base
