#pragma once
// Sideslip and lateral tyre forces of a car, as a derived sensor (docs/derived.md).
//
// In a world file, inside a robot:
//   derived( type "sideslip"  inputs ["gyro" "encoder" "command"]  rate 50  observer "ekf"  mass 1225.9  inertia 1538.9
//     axles [0.884 1.509]  stiffness [0.45 0.726]  friction [1.2801 23.99 0.52]  noise [0.2 0.05]  start_speed 25 )
// `observer`: luenberger, extended-luenberger, ekf or sliding-mode. `axles`: distances of the axles from the centre of
// gravity. `stiffness`, `friction`: of the tyres, see robots::CarModel. `noise`: standard deviations of yaw rate (angle
// per second) and speed (length per second), for the filter. `start_speed`: the car drives straight ahead at that speed
// when the sensor starts; without it, the first speed starts the observer.
// Inputs, at most one each: yaw rate (rate_rad_s), speed (speed_m_s) or encoder (left_m, right_m) of wheels that are
// not driven, steering angle of the front wheels (steer_rad) or the robot's command, torque on the front wheels
// (torque_n_m).
//
// A reading is one row: sideslip of the centre of gravity, lateral force of the front and of the rear tyres, whether
// they are valid, and their covariance, which only the filter states. Not valid: before the start, and below
// robots::kSlipSpeed.

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kSideslip = 33;  ///< wire id

extern const SensorType sideslip_type;

}  // namespace sf::sensors
