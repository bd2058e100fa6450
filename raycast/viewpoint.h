#pragma once
// Poses of sensors that are due.

#include <cstdint>

#include "base/pose.h"

namespace sf::raycast {

/// A sensor that is due.
struct Viewpoint {
  std::uint32_t config = 0;
  std::uint32_t self = 0;  ///< mover that carries it
  base::Pose X_WS;
  glm::dvec2 heading;  ///< unit vector of the yaw
};

}  // namespace sf::raycast
