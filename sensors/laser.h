#pragma once
// The laser range finder: fans of beams (raycast/ray_caster.h says how exact), their noise, and what `resolution`
// leaves out.

#include "sensors/kind.h"

namespace sf::sensors {

extern const SensorKind laser_kind;

}  // namespace sf::sensors
