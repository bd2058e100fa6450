#pragma once
// Gyroscopes: how fast a robot turns about the vertical (docs/sensors.md).
//
// In a world file, inside a robot:
//   gyro( bias 0.5  noise 0.1  scale_error 0.01  range 300 )
// `bias` is the standard deviation of an offset that is drawn once for each run, `noise` that of each reading by
// itself, both in angles per second; `scale_error` that of a relative error drawn once for each run; `range` what it
// saturates at, either way. Nothing said: a perfect one.
//
// A reading is one number: the turn rate that the robot reports, and these.

#include <cstdint>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kGyro = 9;  ///< wire id

/// What a world file says of one gyro.
struct Gyro {
  double bias = 0.0;         ///< [rad/s] standard deviation
  double noise = 0.0;        ///< [rad/s] standard deviation
  double scale_error = 0.0;  ///< [-] standard deviation
  double range = 1e3;        ///< [rad/s] > 0
};

/// @throws base::InputError with file and line.
Gyro read_gyro(const world::Sensor& sensor);

extern const SensorType gyro_type;

}  // namespace sf::sensors
