#pragma once
// Thermometers: the temperature of the world's scalar field at a point (docs/sensors.md).
//
// In a world file, inside a robot:
//   thermometer( noise 0.5  bias 1 )
// `noise`: standard deviation of a reading [K]; `bias`: standard deviation of an offset that is constant in a run [K].
// A reading is one row: the temperature in degrees Celsius.

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kThermometer = 42;  ///< wire id

/// Settings of one thermometer.
struct Thermometer {
  double noise = 0.0;  ///< [K]
  double bias = 0.0;   ///< [K]
};

/// Returns the temperature [degrees Celsius] at `p` [m] in the world: that of the world and, for each source at
/// distance d, rise * exp(-(d / radius)^2 / 2). The field is stationary, and walls do not change it.
double temperature_at(const world::World& world, const glm::dvec2& p);

extern const SensorType thermometer_type;

}  // namespace sf::sensors
