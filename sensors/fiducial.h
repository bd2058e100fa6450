#pragma once
// Fiducial finders: detect models with a `fiducial_return` (targets, threats, markers) in sight (docs/sensors.md).
//
// In a world file, inside a robot, with the keys of Stage's `fiducial`:
//   fiducial( range_min 0  range_max 8  range_max_id 5  fov 360  fiducial_key 0  detections 8  noise [0.01 1 1] )
// A finder is at half its model's height and looks along its x axis. A fiducial is detected when its middle is within
// range and field of view and no other surface crosses the straight line to it: half a fiducial in sight is detected if
// that half contains its middle. A reading has `detections` rows, the nearest fiducial first; the rest are NaN.

#include <cstdint>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kFiducial = 27;         ///< wire id
inline constexpr std::uint32_t kMostDetections = 62;  ///< rows of a reading: one datagram
inline constexpr std::uint32_t kFiducialNumbers = 5;  ///< numbers of a row: id, type, range, bearing, orientation

/// Settings of one finder.
struct FiducialFinder {
  double range_min = 0.0;                               ///< [m] >= 0
  double range_max = 8.0;                               ///< [m] > 0
  double range_max_id = 5.0;                            ///< [m] farther fiducials are detected with id 0
  double fov = 2.0 * M_PI;                              ///< [rad] in (0, 2 pi]
  std::uint32_t key = 0;                                ///< detects the fiducials with this key
  double range_noise = 0.0;                             ///< [m] standard deviation
  double bearing_noise = 0.0, orientation_noise = 0.0;  ///< [rad] standard deviations
};

/// @throws base::InputError for invalid settings
FiducialFinder read_finder(const world::Sensor& sensor);

extern const SensorType fiducial_type;

}  // namespace sf::sensors
