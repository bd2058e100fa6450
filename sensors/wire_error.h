#pragma once
// Errors added by rounding a reading's numbers to the words of a packet.

#include <cstddef>
#include <span>

namespace sf::sensors {

/// Implements `SensorType::wire_error` for a wire with steps of `step`, rounded to nearest, for values in
/// [least, most], all in the unit of the first column. Infinite values have their own words. @param width numbers per
/// element
double wire_error(std::span<const double> values, std::size_t width, double step, double least, double most);

}  // namespace sf::sensors
