#pragma once
// Warnings of numbers that are likely to be in another unit than the file's: radians and degrees, millimetres and
// metres. Plausible numbers are never warned of.

#include <string_view>

#include "world/stage/build_state.h"

namespace sf::world {

/// Warns of a field of view or range of a sensor or an infrared emitter, once per line of the file.
/// @param type the sensor type's word, whose ranges differ
void warn_of_units(BuildState& b, const Property& property, std::string_view type);

/// The same angle in degrees, where `angle` is likely to be one in radians: 25 to 360 degrees, rounded or cut off to
/// two decimals or more; else 0.
double degrees_of_radians(double angle);

}  // namespace sf::world
