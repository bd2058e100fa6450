#pragma once
// Noise of sensors, number by number, which faults multiply.

#include <cstdint>

#include "sensors/sensor_set.h"

namespace sf::farm {

/// Returns the standard deviation of the noise of one number [unit of its column], without errors that last, such as a
/// bias; infinite: not stated.
/// @param row of the group  @param offset index of the number in an element
double own_noise(const sensors::SensorSet::Group& group, const sensors::SensorSpec& row, std::uint32_t offset);

}  // namespace sf::farm
