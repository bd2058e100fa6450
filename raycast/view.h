#pragma once
// Where sensors look from.

#include <cstdint>

#include "base/pose.h"

namespace sf::raycast {

/// Sensors that can share lists: one height, one range.
struct Family {
  double z = 0.0;             ///< [m] world height of the sensors
  double range = 0.0;         ///< [m]
  double spread = 0.0;        ///< [rad] largest of its sensors, as in CellShape
  double fov = 0.0;           ///< [rad] largest of its sensors, with all that noise may add
  std::uint32_t beams = 361;  ///< that one robot casts in a tick: many are worth small cells
};

/// A sensor about to look.
struct Viewpoint {
  std::uint32_t family = 0;
  std::uint32_t self = 0;  ///< mover that carries it
  base::Pose X_WS;
};

}  // namespace sf::raycast
