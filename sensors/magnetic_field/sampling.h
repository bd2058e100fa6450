#pragma once
// The field of a world as it was loaded at any number of places: for pictures and measurements.

#include <functional>
#include <span>
#include <vector>

#include "sensors/magnetic_field/magnetic_field.h"

namespace sf::sensors {

struct FieldSampleOptions {
  bool magnitudes = false;  ///< also add up the magnets' own magnitudes
  unsigned threads = 0;     ///< for the host's part; 0: as many as the machine has. Never changes a sum
  std::function<void(double done)> progress;  ///< called now and then with the part in (0, 1] that is done
};

/// By the kernel of the magnetometers, in batches. Quick where each five places in a row are neighbours.
/// @return one sum a place. @throws base::DeviceError when the device cannot hold the magnets.
std::vector<FieldSum> sample_field(const world::World& world, gpu::Device& device, std::span<const FieldPoint> points,
                                   const FieldSampleOptions& options = {});

}  // namespace sf::sensors
