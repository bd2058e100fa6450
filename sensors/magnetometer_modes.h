#pragma once
// The magnetometer's modes: how far each looks for magnets, and what that may leave out.

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr AccuracyMode kMagnetometerModes[] = {
    {"exact", "all magnets, or those within the world's magnet_cutoff"},
    {"near10", "magnets within 10 m along the ground"},
    {"near3", "within 3 m"},
    {"near1", "within 1 m"},
};

/// [m] a mode's cut-off, or the world's where that is nearer; 0: none.
double cutoff_of(const world::World& world, std::uint8_t mode);

/// Largest error of a field, and of a magnitude, at one height, wherever movers are.
struct FieldBound {
  double fixed = 0.0;      ///< [T] what the cut-off leaves out, and arithmetic
  double per_metre = 0.0;  ///< [T/m] times the farthest coordinate: places far from the origin are rounded
  double at(double farthest) const { return fixed + per_metre * farthest; }
};
/// Of a mode at `height` [m]; infinite where a magnet is as high as the sensor, which may then stand in its very
/// middle.
FieldBound field_bound(const world::World& world, std::uint8_t mode, double height);

/// [m] heights of its elements in the world, each once, ascending.
std::vector<double> element_heights(const world::Mover& mover, const world::Sensor& sensor);

ErrorBound bound_of_magnetometer(const world::World& world, const SensorSpec& sensor);

}  // namespace sf::sensors
