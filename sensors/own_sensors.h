#pragma once
// Registers users' own sensor types (sensorfarm/sensor.h) as types of the farm.

#include <span>
#include <string>
#include <string_view>

#include "sensorfarm/sensor.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kFirstOwnId = 13;
inline constexpr std::uint8_t kLastOwnId = 26;

/// Properties common to all user-defined types.
struct OwnTypeFacts {
  std::string_view name;
  std::uint8_t id = 0;
  std::span<const sensorfarm::SensorColumn> columns;
  double rate = 0.0;  ///< [Hz]
  bool has_make = false;
};
/// @throws base::InputError for a name or id that is taken, and for anything unusable
void check_own_type(const OwnTypeFacts& facts, const std::string& from);

/// Adds a type for the rest of the program. Worlds loaded from now on may have such sensors. Do not call it while a
/// farm ticks.
/// @param from file that defines the type: used in messages, and to resolve a kernel's relative path
/// @throws base::InputError for a name or id that is taken or unusable, and for a kernel that cannot be read
void add_own_sensor(sensorfarm::SensorEntry entry, const std::string& from);

}  // namespace sf::sensors
