#pragma once
// What the rounding of a reading's numbers to the words of a packet adds to their error.

#include <cstddef>
#include <span>

namespace sf::sensors {

/// `SensorType::wire_error` of a wire with steps of `step`, rounded to nearest, for values in [least, most], all in the
/// unit of the first column. Infinite values have words of their own. @param width numbers per element
double wire_error(std::span<const double> values, std::size_t width, double step, double least, double most);

}  // namespace sf::sensors
