#pragma once
// Cliff sensors: points under a robot that look down for the floor (docs/sensors.md).
//
// In a world file, inside a robot:
//   cliff( scount N  spose[0] [x y yaw] ... )
// Points are in the frame of their model and keep the order of the file. A reading has one row for each: 1 where there
// is no floor, that is within the outline of a drop (world::FloorHole), else 0.

#include <cstdint>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kCliff = 7;              ///< wire id
inline constexpr std::uint32_t kMostCliffPoints = 32;  ///< of one sensor

extern const SensorType cliff_type;

}  // namespace sf::sensors
