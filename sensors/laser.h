#pragma once
// The laser range finder: scans of beams (raycast/ray_caster.h states their accuracy), noise, and interpolation for
// `resolution`.

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kLaser = 1;  ///< wire id

extern const SensorType laser_type;

}  // namespace sf::sensors
