#pragma once
// Bumpers: switches that are pressed where something presses on the body (docs/sensors.md).
//
// In a world file, inside a robot:
//   bumper( zones N  zone[0] [from to] ... zone[N-1] [from to] )
// Zone i is the arc of bearings from `from` counter-clockwise to `to`, seen from the robot's origin and turned with the
// sensor's own yaw; zones may overlap. Without zones there is one switch all round. Stage's bars (`bcount`, `bpose[i]`
// [x y z angle], `blength`) are understood as the arcs between their ends.
//
// A reading has one row for each switch: 1 while it is pressed, else 0. Contacts are told in sectors
// (base::kContactSectors); a sector belongs to the zones that hold its middle.

#include <cstdint>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kBumper = 6;             ///< wire id
inline constexpr std::uint32_t kMostBumperZones = 32;  ///< of one sensor

/// The sectors of each switch, bit k as in base::Report::contact_mask, never none.
/// @throws base::InputError with file and line.
std::vector<std::uint32_t> read_bumper(const world::Sensor& sensor);

extern const SensorType bumper_type;

}  // namespace sf::sensors
