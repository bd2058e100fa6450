#pragma once
// Inclinometers: roll and pitch against gravity (docs/inertial.md).
//
// In a world file, inside a robot:
//   inclinometer( noise 0.05  bias 0.2  range 30 )
// A reading is one row: roll and pitch in radians (base::Tilt), and which of them saturated.

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kInclinometer = 49;  ///< wire id

extern const SensorType inclinometer_type;

}  // namespace sf::sensors
