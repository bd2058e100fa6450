#pragma once
// Light sensors: elements that measure the illuminance of lamps and of ambient light (docs/sensors.md).
//
// In a world file, inside a robot:
//   lightsensor( scount 8  spose[0] [x y yaw] ...  dark 450  bright 1000 )
// Elements are at half their model's height, look along their x axis and keep the order of the file. A reading has one
// row per element: the illuminance, and a whole number that falls linearly from `dark` in darkness to 0 at `bright`.

#include <cstdint>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kLightSensor = 13;         ///< wire id
inline constexpr std::uint32_t kMostLightElements = 64;  ///< per sensor
inline constexpr double kFaintest = 1e-3;                ///< [lx] lamps count where they give this or more
inline constexpr double kNearestLamp = 0.01;             ///< [m] smaller distances count as this one
inline constexpr double kMostLightValue = 1023.0;        ///< of `value`: ten bits

/// Settings of one sensor.
struct LightSensor {
  std::vector<Pose> X_SE;  ///< per element, in the sensor frame
  double dark = 450.0;     ///< [-] value in darkness, in [0, 1023]
  double bright = 1000.0;  ///< [lx] > 0, least illuminance with value 0
};

/// Returns the illuminance [lx] of a lamp on a vertical surface at `p` [m] (world) that faces `normal` (unit length):
/// I cos(incidence) / r^2. 0 behind the surface, outside the lamp's beam, or where I / r^2 is below kFaintest. Ignores
/// walls.
double illuminance_of(const world::Lamp& lamp, const glm::dvec3& p, glm::dvec2 normal);

/// Returns the distance [m] from which on the lamp does not count.
double range_of(const world::Lamp& lamp);

extern const SensorType lightsensor_type;

}  // namespace sf::sensors
