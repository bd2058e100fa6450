#pragma once
// Sonar: transducers that measure the nearest echo in a cone (docs/sensors.md).
//
// In a world file, inside a robot:
//   sonar( scount 16  spose[0] [x y yaw] ...  fov 25  range [0.10 4]  rays 11  firing "sequential"  arrays 2
//          incidence 90  noise [constant proportional] )
// Lengths and angles are in the file's units.
//
// A reading has one column per transducer: the range [m] of the nearest surface hit by one of the cone's rays, clamped
// to [range_min, range_max]; range_max if there is no echo before it.

#include <cstdint>

#include "sensors/cones/cone_array.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kSonar = 4;  ///< wire id

/// @throws base::InputError with file and line.
ConeArray read_sonar(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_type);

extern const SensorType sonar_type;

}  // namespace sf::sensors
