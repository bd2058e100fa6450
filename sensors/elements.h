#pragma once
// Positions of an array's elements in Stage's syntax: `scount N`, then for each element `spose[i] [x y yaw]` or, with a
// height, `spose3[i] [x y z yaw]`.

#include <cstdint>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Returns the poses of the elements in the sensor frame [m, rad], in order; one element at the origin when nothing is
/// set.
/// @throws base::InputError when an element is missing, defined twice, beyond `scount` or too far away, or when there
/// are more than `most`
std::vector<Pose> read_elements(const world::Sensor& sensor, std::uint32_t most);

}  // namespace sf::sensors
