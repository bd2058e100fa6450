#pragma once
// The field of a world at load at any number of points, for images and measurements.

#include <functional>
#include <span>
#include <vector>

#include "sensors/magnetic_field/magnetic_field.h"

namespace sf::sensors {

struct FieldSampleOptions {
  bool magnitudes = false;                    ///< also sums the magnitudes of the magnets' fields
  unsigned threads = 0;                       ///< host threads; 0: one per core; results do not depend on it
  std::function<void(double done)> progress;  ///< called occasionally with the finished fraction in (0, 1]
};

/// Computes the field with the magnetometers' kernel, in batches. Fastest when every five consecutive points are
/// neighbours.
/// @return one sum per point  @throws base::DeviceError when the device cannot hold the magnets
std::vector<FieldSum> sample_field(const world::World& world, gpu::Device& device, std::span<const FieldPoint> points,
                                   const FieldSampleOptions& options = {});

}  // namespace sf::sensors
