#pragma once
// Poses of due sensors.

#include <cstdint>

#include "base/pose.h"

namespace sf::raycast {

/// A due sensor.
struct Viewpoint {
  std::uint32_t config = 0;
  std::uint32_t self = 0;  ///< mover that carries the sensor
  base::Pose X_WS;
  glm::dvec2 heading;  ///< unit vector of the yaw
};

}  // namespace sf::raycast
