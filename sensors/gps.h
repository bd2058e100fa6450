#pragma once
// Satellite positioning, which loses its fix under bridges and between walls (docs/sensors.md).
// sensors/gnss_visibility.h describes the constellation and visibility.
//
// In a world file, inside a robot:
//   gps( satellites 8  noise 2  rate 1  latency 0.1  altitude 1 )
// `noise`: standard deviation of the range to each satellite. The antenna is at the top of its model. The default rate
// is 1 Hz.
//
// A reading is one row: x and y of the antenna in the world frame, HDOP, and the number of visible satellites. Position
// errors are `noise` times the dilution of precision, independent between readings. Without a fix (fewer than four
// satellites) x, y and HDOP are NaN. With `altitude 1`, a reading has the height of the antenna and VDOP, too; in a
// world with such a receiver all readings have both, NaN for the others.

#include <array>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "sensors/gnss_visibility.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kGps = 10;              ///< wire id
inline constexpr std::uint32_t kMostSatellites = 64;  ///< in the constellation
inline constexpr double kGpsRate = 1.0;               ///< [Hz] default

/// Settings of one receiver.
struct Gps {
  std::uint32_t satellites = 8;  ///< in [4, kMostSatellites]
  double noise = 0.0;            ///< [m] standard deviation of a range
  bool altitude = false;         ///< measures the height, too
};

/// Measures readings of one receiver.
struct GpsModel {
  /// Returns x, y [m], HDOP, the number of visible satellites, z [m] and VDOP of reading `draw.c`.
  /// @param X_WS pose of the antenna
  std::array<double, 6> measure(const GnssVisibility& visibility, const base::RandomKey& draw, const Pose& X_WS) const;

  double noise = 0.0;  ///< [m] standard deviation of a range
  std::vector<Satellite> satellites;
};

/// @throws base::InputError with file and line.
Gps read_gps(const world::Sensor& sensor);

extern const SensorType gps_type;

}  // namespace sf::sensors
