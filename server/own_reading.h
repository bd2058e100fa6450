#pragma once
// A reading of a sensor that a real robot carries.

#include <cmath>
#include <cstdint>
#include <vector>

namespace sf::server {

/// Newest reading of one of the robot's own sensors, in the columns of the virtual sensor type.
struct OwnReading {
  std::uint8_t type = 0;       ///< wire id of the sensor type
  std::uint32_t sequence = 0;  ///< number of the reading, from 0
  std::int64_t time = 0;       ///< [ns] of its arrival
  std::vector<double> values;
  double limit = HUGE_VAL;   ///< [m] ranges from this one on are no echo
  double fov = 0.0;          ///< [rad] of a laser, from its first beam to its last
  std::uint16_t sensor = 0;  ///< among the robot's own sensors of this type
};

}  // namespace sf::server
