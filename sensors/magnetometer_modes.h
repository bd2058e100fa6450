#pragma once
// The magnetometer's accuracy modes: cut-off distances and error bounds.

#include <algorithm>
#include <span>

#include "base/report.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr AccuracyMode kMagnetometerModes[] = {
    {"exact", "all magnets, or those within the world's magnet_cutoff"},
    {"near10", "magnets within 10 m along the ground"},
    {"near3", "within 3 m"},
    {"near1", "within 1 m"},
};

/// Returns the cut-off of a mode [m]: the smaller of the mode's and the world's; 0: none.
double cutoff_of(const world::World& world, std::uint8_t mode);

/// Largest error of a field, and of a magnitude, at one height, for all poses of movers.
struct FieldBound {
  double fixed = 0.0;      ///< [T] cut-off and arithmetic
  double per_metre = 0.0;  ///< [T/m] multiplied by the largest coordinate: rounding errors of points far from the
                           ///< origin
  void include(const FieldBound& other) {
    fixed = std::max(fixed, other.fixed);
    per_metre = std::max(per_metre, other.per_metre);
  }
  double at(double farthest) const { return fixed + per_metre * farthest; }
};
/// Returns the bound of a mode at `height` [m], with movers at their heights at load; infinite if a magnet has the
/// sensor's height, because the sensor may then reach its centre.
FieldBound field_bound(const world::World& world, std::uint8_t mode, double height);
/// Same with movers at the heights of `states`. @param cut [T] bound of the cut-off
FieldBound field_bound(const world::World& world, std::span<const base::Report> states, double cut, double height);

/// Returns the heights of the elements in the world [m], each once, ascending.
std::vector<double> element_heights(const world::Mover& mover, const world::Sensor& sensor);

}  // namespace sf::sensors
