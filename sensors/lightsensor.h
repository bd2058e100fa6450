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

inline constexpr std::uint8_t kLightSensor = 28;         ///< wire id
inline constexpr std::uint32_t kMostLightElements = 64;  ///< per sensor
inline constexpr double kMostLightValue = 1023.0;        ///< of `value`: ten bits

/// Settings of one sensor.
struct LightSensor {
  std::vector<Pose> X_SE;  ///< per element, in the sensor frame
  double dark = 450.0;     ///< [-] value in darkness, in [0, 1023]
  double bright = 1000.0;  ///< [lx] > 0, least illuminance with value 0
};

extern const SensorType lightsensor_type;

}  // namespace sf::sensors
