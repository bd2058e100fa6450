#pragma once
// Gyroscopes: yaw rate of a robot (docs/sensors.md).
//
// In a world file, inside a robot:
//   gyro( bias 0.5  noise 0.1  scale_error 0.01  range 300 )
// `bias`: standard deviation of an offset drawn once per run. `noise`: standard deviation of each reading. Both are in
// angles per second. `scale_error`: standard deviation of a relative error drawn once per run. `range`: saturation in
// both directions. The default has no error.
//
// A reading is one number: the yaw rate of the robot's report with these errors.

#include <cstdint>

#include "base/random.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kGyro = 9;  ///< wire id

/// Settings of one gyro.
struct Gyro {
  double bias = 0.0;         ///< [rad/s] standard deviation
  double noise = 0.0;        ///< [rad/s] standard deviation
  double scale_error = 0.0;  ///< [-] standard deviation
  double range = 1e3;        ///< [rad/s] > 0
};

/// A gyro with the errors drawn for one run.
class GyroModel {
 public:
  /// @param draw key of its random numbers; its `c` is ignored
  GyroModel(const Gyro& gyro, const base::RandomKey& draw, bool noise);
  /// Returns reading number `sequence` [rad/s]. @param turn [rad/s] true yaw rate
  double measure(double turn, std::uint64_t sequence) const;

 private:
  base::RandomKey draw_;
  double range_;
  double scale_ = 1.0;
  double bias_ = 0.0;
  double noise_ = 0.0;
};

/// @throws base::InputError with file and line.
Gyro read_gyro(const world::Sensor& sensor);

extern const SensorType gyro_type;

}  // namespace sf::sensors
