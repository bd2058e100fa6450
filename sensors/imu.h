#pragma once
// Inertial measurement units: angular rate and specific force (docs/inertial.md).
//
// In a world file, inside a robot:
//   imu( preset "MPU-6050"  rate 100  pose6 [0.1 0 0.2 0 0 90]  gyro_bias 0.5  accel_noise 0.001 )
// Keys are listed in docs/inertial.md. The default has no error.
//
// A reading is one row: the means of the angular rate and of the specific force over the last interval, 1 / `rate`, in
// the sensor's frame, and which axes saturated. At rest and level it is (0 0 0) and (0 0 9.80665). With `orientation`,
// also the orientation that the device estimates from these, a quaternion (w x y z) of the sensor in the world.

#include "sensors/sensor_type.h"
#include "sensors/triad.h"

namespace sf::sensors {

inline constexpr std::uint8_t kImu = 46;             ///< wire id
inline constexpr double kImuRate = 100.0;            ///< [Hz] default
inline constexpr double kLeastImuRate = 1.0;         ///< [Hz]: a mean is over all ticks since the last reading
inline constexpr double kStandardGravity = 9.80665;  ///< [m/s^2]

/// Gains of the filter of the orientation (sensors/attitude_filter.h), as in the experiments of its authors.
inline constexpr double kAttitudeGain = 1.0, kAttitudeBiasGain = 0.3;  ///< [1/s], [1/s^2]

/// Settings of one unit.
struct Imu {
  base::RigidTransform X_MS;          ///< sensor in the mover's frame
  double gravity = kStandardGravity;  ///< [m/s^2] >= 0, along -z of the world
  TriadErrors gyro;                   ///< [rad/s]
  TriadErrors accel;                  ///< [m/s^2]
  double g_sensitivity = 0.0;         ///< [rad/s per m/s^2] deviation of the response of each gyro to each axis
  bool orientation = false;           ///< is estimated
  double gain = kAttitudeGain, bias_gain = kAttitudeBiasGain;  ///< [1/s], [1/s^2] >= 0
};

/// @throws base::InputError with file and line.
Imu read_imu(const world::Sensor& sensor);

extern const SensorType imu_type;

}  // namespace sf::sensors
