#pragma once
// Users' own sensor types (sensorfarm/sensor.h) as types of the farm.

#include <string>

#include "sensorfarm/sensor.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kFirstOwnId = 13;
inline constexpr std::uint8_t kLastOwnId = 31;

/// Adds it for the rest of the program: worlds loaded from now on may have such sensors. Not while a farm ticks.
/// @param from file it comes from: for messages, and its folder is that of a kernel with a relative path
/// @throws base::InputError for a name or id that is taken or unusable, and for a kernel that cannot be read
void add_own_sensor(sensorfarm::SensorEntry entry, const std::string& from);

}  // namespace sf::sensors
