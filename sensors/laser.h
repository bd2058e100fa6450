#pragma once
// The laser range finder: fans of beams (raycast/ray_caster.h says how exact), their noise, and what `resolution`
// leaves out.

#include "sensors/sensor_type.h"

namespace sf::sensors {

extern const SensorType laser_type;

}  // namespace sf::sensors
