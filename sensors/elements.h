#pragma once
// Where the elements of an array are, as Stage's rangers say it: `scount N`, then `spose[i] [x y yaw]` or, lifted,
// `spose3[i] [x y z yaw]` for each.

#include <cstdint>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Each element in the sensor's frame [m, rad], in order of its number; one in the middle where nothing is said.
/// @throws base::InputError where one is missing, given twice, beyond `scount` or too far away, or more than `most`.
std::vector<Pose> read_elements(const world::Sensor& sensor, std::uint32_t most);

}  // namespace sf::sensors
