#include "sensors/magnetometer_modes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "robots/fleet.h"
#include "sensors/magnetic_field/magnet_tree.h"
#include "sensors/magnetic_field/truncation.h"
#include "sensors/magnetometer.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kCutoffs[] = {0.0, 10.0, 3.0, 1.0};  // [m] per mode; 0: none
static_assert(std::size(kCutoffs) == std::size(kMagnetometerModes));

constexpr double kArithmetic = 1e-12;  // relative to a magnet's field
constexpr double kTooNear = 4e-6;      // [m] distance from a magnet's centre below which rounding dominates
                                       // (magnetic_field.h)

/// Returns the relative error of a magnet's field due to 32-bit rounding of its moment and, if `height` [m] is within
/// its radius, of the inverse radius.
double lost_part(const world::Magnet& magnet, double height) {
  const double moment = std::abs(magnet.moment);
  const DipoleRow row = dipole_row(magnet, magnet.p, magnet.z);
  double part = moment > 0.0 ? std::abs(std::abs(double{row.moment}) - moment) / moment : 0.0;
  if (height < magnet.radius) part += 3.0 * std::abs(magnet.radius * double{row.inverse_radius} - 1.0);
  return part;
}

/// Adds the bound of one magnet, `height` [m] above or below the sensor. Its field is at most 2 k / r^3, where r is the
/// larger of height and radius. The field changes by at most 12 k / (r^3 height) per metre, and a point is off by 16
/// roundings.
void add(const world::Magnet& magnet, double height, FieldBound& bound) {
  const double nearest = std::max(height, magnet.radius);
  const double largest = 2.0 * strength_of(magnet) / (nearest * nearest * nearest);
  bound.fixed += (kArithmetic + lost_part(magnet, height)) * largest;
  bound.per_metre += height > kTooNear ? 16.0 * 0x1p-53 * 6.0 * largest / height : HUGE_VAL;
}

}  // namespace

double cutoff_of(const world::World& world, std::uint8_t mode) {
  const double own = kCutoffs[mode];
  if (own == 0.0 || world.magnet_cutoff == 0.0) return std::max(own, world.magnet_cutoff);
  return std::min(own, world.magnet_cutoff);
}

FieldBound field_bound(const world::World& world, std::uint8_t mode, double height) {
  return field_bound(world, robots::states_at_load(world), truncation_bound(world, height, cutoff_of(world, mode)),
                     height);
}

FieldBound field_bound(const world::World& world, std::span<const base::Report> states, double cut, double height) {
  FieldBound bound{cut + kArithmetic * glm::length(world.earth_field), 0.0};
  for (const world::Magnet& magnet : world.magnets) add(magnet, std::abs(height - magnet.z), bound);
  for (std::size_t m = 0; m < states.size(); ++m)
    for (const world::Magnet& magnet : world.movers[m].magnets)
      add(magnet, std::abs(height - states[m].X_WM.z - magnet.z), bound);
  return bound;
}

std::vector<double> element_heights(const world::Mover& mover, const world::Sensor& sensor) {
  std::vector<double> heights;
  const double origin = mover.X_WM.z + sensor.X_MS.z + sensor.height / 2.0;
  for (const Pose& X_SE : read_magnetometer(sensor).X_SE) heights.push_back(origin + X_SE.z);
  std::sort(heights.begin(), heights.end());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  return heights;
}

}  // namespace sf::sensors
