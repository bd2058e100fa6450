#pragma once
// Warns about numbers that probably have another unit than the file's: radians instead of degrees, or millimetres
// instead of metres. Plausible numbers never cause a warning.

#include <string_view>

#include "world/stage/build_state.h"

namespace sf::world {

/// Warns about the field of view or range of a sensor or an infrared emitter, once per line of the file.
/// @param type word of the sensor type; types have different ranges
void warn_of_units(BuildState& b, const Property& property, std::string_view type);

/// Returns the angle in degrees if `angle` was probably written in radians: 25 to 360 degrees, rounded or truncated to
/// two decimals or more; else 0.
double degrees_of_radians(double angle);

}  // namespace sf::world
