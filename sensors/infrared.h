#pragma once
// Infrared proximity sensors, such as those of a Khepera: the response to the nearest surface in a cone
// (docs/sensors.md).
//
// In a world file, inside a robot:
//   infrared( scount 8  spose[0] [x y yaw] ...  fov 30  range [0 0.05]  rays 11  noise 0.01 )
// Lengths and angles are in the file's units.
//
// A reading has two columns per element: the range [m] that corresponds to the response, and the response, an integer:
// 1023 at range_min, falling linearly to 0 at range_max, and 0 without a surface.

#include <cstdint>

#include "sensors/cones/cone_array.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kInfrared = 5;          ///< wire id
inline constexpr double kMostResponse = 1023.0;       ///< 10 bits
inline constexpr std::uint32_t kInfraredColumns = 2;  ///< per element: range [m], response

/// @throws base::InputError with file and line.
ConeArray read_infrared(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_type);

/// Returns the response to a surface at `range` [m], without noise.
double infrared_response(double range, const base::RangeLimits& limits);

/// Returns the standard deviation of a range [m]. @param noise relative, of the response
double infrared_sigma(double range, const base::RangeLimits& limits, double noise);

extern const SensorType infrared_type;

}  // namespace sf::sensors
