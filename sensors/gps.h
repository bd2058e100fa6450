#pragma once
// Satellite positioning that loses its fix under bridges and between walls (docs/sensors.md; sensors/gnss_visibility.h
// has the constellation and what blocks a line of sight).
//
// In a world file, inside a robot:
//   gps( satellites 8  noise 2  rate 1  latency 0.1 )
// `noise` is the standard deviation of the range to each satellite. The antenna is on top of its model. Once a second,
// unless `rate` says otherwise.
//
// A reading is one row: x and y of the antenna in the world frame with errors of noise times the dilution of precision
// of the satellites in sight, the horizontal dilution, and how many are in sight. Without a fix (fewer than four) x, y
// and hdop are NaN. Readings' errors are independent of each other.

#include <cstdint>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kGps = 10;              ///< wire id
inline constexpr std::uint32_t kMostSatellites = 64;  ///< of the sky

/// What a world file says of one receiver.
struct Gps {
  std::uint32_t satellites = 8;  ///< in [4, kMostSatellites]
  double noise = 0.0;            ///< [m] standard deviation of a range
};

/// @throws base::InputError with file and line.
Gps read_gps(const world::Sensor& sensor);

extern const SensorType gps_type;

}  // namespace sf::sensors
