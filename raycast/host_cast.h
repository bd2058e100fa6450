#pragma once
// One fan of beams cast on the host, in 64 bits throughout: for viewpoints whose surfaces are more than the device's
// lists hold. The same bytes as the device gives.

#include <cstdint>
#include <span>
#include <vector>

#include "raycast/decide.h"

namespace sf::raycast {

/// The beams of one fan, as the device's tables have them.
struct HostFan {
  base::Vec2 origin;                 ///< [m] world
  base::Vec2 heading;                ///< unit vector
  std::span<const double> bearings;  ///< cosine and sine of each beam, in the sensor's frame
  double range_min = 0.0;            ///< [m]
  double range_max = 0.0;            ///< [m]
};

/// Scratch of one thread, and the answers.
struct HostCast {
  std::vector<Surface> surfaces;     ///< to be filled in before the cast: all that may be met
  std::vector<Decision> decisions;   ///< one a beam, in their order; ranges are at least range_min
  std::vector<double> turns;         ///< where beams and surfaces lie round the origin: `turn_of`
  std::vector<std::uint32_t> order;  ///< beams by their turn
  std::vector<base::Vec2> directions;
};

/// Fills in `cast.decisions`.
void cast_on_host(const HostFan& fan, HostCast& cast);

}  // namespace sf::raycast
