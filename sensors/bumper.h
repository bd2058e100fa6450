#pragma once
// Bumpers: contact switches on the body (docs/sensors.md).
//
// In a world file, inside a robot:
//   bumper( zones N  zone[0] [from to] ... zone[N-1] [from to] )
// Zone i is the arc of bearings from `from` counter-clockwise to `to`, as seen from the robot's origin and rotated by
// the sensor's own yaw. Zones may overlap. Without zones there is one switch for all bearings. Stage's bars (`bcount`,
// `bpose[i]` [x y z angle], `blength`) are read as the arcs between their ends.
//
// A reading has one row per switch: 1 while pressed, else 0. Contacts are reported by sector (base::kContactSectors). A
// sector belongs to each zone that contains its centre.

#include <cstdint>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kBumper = 6;             ///< wire id
inline constexpr std::uint32_t kMostBumperZones = 32;  ///< per sensor

/// The sectors of each switch of a sensor, bit k as in base::Report::contact_mask; at least one per switch.
using BumperSwitches = std::vector<std::uint32_t>;

/// @throws base::InputError with file and line.
BumperSwitches read_bumper(const world::Sensor& sensor);

extern const SensorType bumper_type;

}  // namespace sf::sensors
