#pragma once
// Registers users' own derived sensor types (sensorfarm/derived.h) as types of the farm.

#include <string>

#include "sensorfarm/derived.h"

namespace sf::sensors {

/// Adds a type for the rest of the program, like `add_own_sensor`.
/// @param from file that defines the type, for messages
/// @throws base::InputError for a name or id that is taken or unusable
void add_own_derived(sensorfarm::DerivedEntry entry, const std::string& from);

}  // namespace sf::sensors
