#pragma once
// Cliff sensors: points under a robot that detect the floor (docs/sensors.md).
//
// In a world file, inside a robot:
//   cliff( scount N  spose[0] [x y yaw] ... )
// Points are in the frame of their model and keep the order of the file. A reading has one row per point: 1 inside the
// outline of a drop-off (world::FloorHole), where there is no floor, else 0.

#include <cstdint>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kCliff = 7;              ///< wire id
inline constexpr std::uint32_t kMostCliffPoints = 32;  ///< per sensor

extern const SensorType cliff_type;

}  // namespace sf::sensors
