#pragma once
// Lidars: spatial scans, in the scene of solids that the world's outlines and heights describe (docs/sensors.md).
//
// In a world file, inside a robot:
//   lidar( channels 64  fov_v [-24.8 2]  columns 1024  fov 360  range [0 100]  noise [0.02 0]  pose6 [0 0 0.3 0 5 0] )
//   lidar( preset "OS1-64" )
// A reading has one range per beam, ring by ring from the first elevation, counter-clockwise. The sensor is at half of
// its model's height and tilts with its robot. It sees all outlines that lasers see, with their tops and bottoms, all
// other movers, and the floor at z = 0.

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kLidar = 44;  ///< wire id

extern const SensorType lidar_type;

}  // namespace sf::sensors
