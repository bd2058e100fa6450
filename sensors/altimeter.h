#pragma once
// Barometric altimeters: height above a datum (docs/inertial.md).
//
// In a world file, inside a robot:
//   altimeter( datum 0  noise 0.1  bias 2  walk 0.03  step 0.01 )
// A reading is one row: the height in metres.

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kAltimeter = 48;  ///< wire id

extern const SensorType altimeter_type;

}  // namespace sf::sensors
