#pragma once
// The laser range finder: scans of beams (raycast/ray_caster.h states their accuracy), noise, and interpolation for
// `resolution`.

#include "sensors/sensor_type.h"

namespace sf::sensors {

extern const SensorType laser_type;

}  // namespace sf::sensors
