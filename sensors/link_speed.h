#pragma once
// Mean speeds and travel times of stretches of road (links), from reports of vehicles and from loop detectors, as a
// derived sensor (docs/derived.md).
//
// In a world file, inside a robot, such as one at the roadside:
//   derived( type "link-speed"  inputs ["*/gps" "*/loop"]  lanes "all"  rate 0.1 )
// Inputs: poses, satellite positions and loops of any robots. A link is a lane of the road network or a line of the
// world file (sensors/road_links.h). Two successive reports of a vehicle on one link are a distance and a time on it.
//
// A reading has a row per link, in order, and one for `route`: speed, travel time, `valid`, their covariance, and the
// age of the newest report.

#include <cstdint>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kLinkSpeed = 37;         ///< wire id
inline constexpr std::uint32_t kLinkSpeedNumbers = 7;  ///< of a row
inline constexpr double kLongestTravel = 3600.0;       ///< [s] of one link; slower speeds state this

extern const SensorType link_speed_type;

}  // namespace sf::sensors
