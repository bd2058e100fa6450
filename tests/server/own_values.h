#pragma once
// Readings of a real robot's own sensors in tests.

#include <cstdint>
#include <vector>

#include "server/real_robot.h"

namespace sf::server {

/// Returns the newest values of its first sensor of a type; empty without one.
inline std::vector<double> own_values(const RealRobot& robot, std::uint8_t type) {
  for (const OwnReading& own : robot.readings())
    if (own.type == type) return own.values;
  return {};
}

}  // namespace sf::server
