#pragma once
// Quality of a mover's state. A reading is only as good as the state that it was computed from.

#include <array>
#include <cstdint>
#include <limits>

namespace sf::base {

/// Age before the first state arrives, while the mover is at its pose from the world file.
inline constexpr std::int64_t kNoStateYet = std::numeric_limits<std::int64_t>::max();

struct StateQuality {
  bool stated = false;   ///< false: unknown; the other members are 0 and false
  bool stale = false;    ///< the state is too old to act on
  std::int64_t age = 0;  ///< [ns] age of the state when it was used, rounded up to 1000 in a packet; or kNoStateYet
  std::array<float, 6> covariance{};  ///< of x, y [m], yaw [rad]: xx, xy, x yaw, yy, y yaw, yaw yaw; 0: unknown
};

}  // namespace sf::base
