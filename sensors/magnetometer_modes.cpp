#include "sensors/magnetometer_modes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sensors/field/magnet_tree.h"
#include "sensors/field/truncation.h"
#include "sensors/magnetometer.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kCutoffs[] = {0.0, 10.0, 3.0, 1.0};  // [m] of each mode
static_assert(std::size(kCutoffs) == std::size(kMagnetometerModes));

constexpr double kRounding = 1e-12;  // of the sum of magnitudes

/// [T] sum of what all magnets have at most at `height` [m].
double largest_magnitudes(const world::World& world, double height) {
  double sum = 0.0;
  const auto add = [&](const world::Magnet& magnet, double z) {
    sum += field_beyond(strength_of(magnet), magnet.radius, std::abs(height - z));
  };
  for (const world::Magnet& magnet : world.magnets) add(magnet, magnet.z);
  for (const world::Mover& mover : world.movers)
    for (const world::Magnet& magnet : mover.magnets) add(magnet, mover.X_WM.z + magnet.z);
  // Within its radius a magnet's field is that at the radius in the same direction: up to twice the one beside it.
  return 2.0 * sum;
}

}  // namespace

double cutoff_of(const world::World& world, std::uint8_t mode) {
  const double own = kCutoffs[mode];
  if (own == 0.0 || world.magnet_cutoff == 0.0) return std::max(own, world.magnet_cutoff);
  return std::min(own, world.magnet_cutoff);
}

double field_bound(const world::World& world, std::uint8_t mode, double height) {
  return truncation_bound(world, height, cutoff_of(world, mode)) + kRounding * largest_magnitudes(world, height);
}

std::vector<double> element_heights(const world::Mover& mover, const world::Sensor& sensor) {
  std::vector<double> heights;
  const double origin = mover.X_WM.z + sensor.X_MS.z + sensor.height / 2.0;
  for (const Pose& X_SE : read_magnetometer(sensor).X_SE) heights.push_back(origin + X_SE.z);
  std::sort(heights.begin(), heights.end());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  return heights;
}

Bound bound_of_magnetometer(const world::World& world, const SensorRow& row) {
  Bound bound;
  for_each_of(world, magnetometer_kind.word.type,
              [&](const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number) {
                if (mover != row.mover || number != row.sensor) return;
                for (const double height : element_heights(world.movers[mover], sensor))
                  bound.error = std::max(bound.error, field_bound(world, row.mode, height));
              });
  return bound;
}

}  // namespace sf::sensors
