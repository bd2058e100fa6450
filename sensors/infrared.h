#pragma once
// Infrared proximity sensors, as around a Khepera: what a lamp's light that comes back says of the nearest surface in a
// cone (docs/sensors.md).
//
// In a world file, inside a robot:
//   infrared( scount 8  spose[0] [x y yaw] ...  fov 30  range [0 0.05]  rays 11  noise 0.01 )
// Lengths and angles are in the file's units.
//
// A reading has two columns for each element: the range [m] that the response stands for, and the response itself, a
// whole number: 1023 at range_min, falling in a straight line to 0 at range_max, where nothing is seen.

#include <cstdint>

#include "sensors/cones/cone_array.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kInfrared = 5;          ///< wire id
inline constexpr double kMostResponse = 1023.0;       ///< 10 bits
inline constexpr std::uint32_t kInfraredColumns = 2;  ///< numbers of one element: range [m], value

/// @throws base::InputError with file and line.
ConeArray read_infrared(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_kind);

extern const SensorType infrared_type;

}  // namespace sf::sensors
