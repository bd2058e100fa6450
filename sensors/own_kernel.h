#pragma once
// The kernel of a user-defined sensor type with its tables (shaders/lib/own_sensor.glsl).

#include <array>
#include <cstdint>
#include <span>

#include "gpu/kernel.h"
#include "sensors/own_backend.h"
#include "sensors/own_sensor_records.h"

namespace sf::sensors {

class OwnKernel {
 public:
  /// @param sensors number in the world  @param elements of the longest reading
  /// @throws base::InputError for a kernel with other tables, base::DeviceError when a table is too large
  OwnKernel(const SensorContext& context, const OwnType& type, std::size_t sensors, std::size_t elements);

  void place_movers();
  /// Sets sample `i` of the next run.
  void add(std::size_t i, const SensorSpec& spec, const Pose& X_WS, const std::array<double, 8>& parameters,
           std::uint64_t sequence);
  /// Sets the number of samples of the next run.
  void close(std::size_t samples);
  void record(gpu::Batch& batch) const { batch.dispatch(kernel_, counts_, 0); }
  void add_copies(gpu::Batch& batch) const;
  /// Returns the results of sample `i`, with the length of the longest reading.
  std::span<const double> values(std::size_t i);

 private:
  void write_walls();

  SensorContext context_;
  std::uint32_t elements_;
  std::uint32_t columns_;
  std::size_t walls_ = 0;     ///< rows of walls
  std::size_t surfaces_ = 0;  ///< rows in use
  std::size_t samples_ = 0;
  gpu::Kernel kernel_;
  gpu::Buffer sample_table_, surface_table_, value_table_, counts_;
};

}  // namespace sf::sensors
