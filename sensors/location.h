#pragma once
// Location: where a robot is, from whichever sensors can tell, as a derived sensor (docs/derived.md).
//
// In a world file, inside a robot:
//   derived( type "location"  inputs ["localization" "gps"]  choose "best"  rate 5 )
// Inputs: receivers (`gps`), whose error is their noise times the HDOP, and sensors whose columns begin with `x_m`,
// `y_m`, `yaw_rad`. The properties of sensors/aggregation.h; `drift` is by default the robot's largest speed.
//
// A reading is one row: x, y of the robot's origin in the world frame, whether they are valid, their covariance, the
// input that they are from and its age. An antenna off the robot's origin is corrected by the newest heading that an
// input states; without one, half its squared distance is added to the variances.

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kLocation = 41;  ///< wire id

extern const SensorType location_type;

}  // namespace sf::sensors
