#pragma once
// Instruments of kinds that need no device: whatever is due is read on the host, by all workers.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

/// One reading to be taken.
struct HostSample {
  std::uint32_t row = 0;       ///< in the kind's rows of this world
  std::uint64_t sequence = 0;  ///< names its noise
  Pose X_WS;                   ///< the sensor's; z: its height in the world as it was at load, the world being 2.5-D
  std::span<double> values;    ///< of all rows and columns, to be filled
};

/// All sensors of one kind that needs no device. One thread.
class HostBackend : public SensorBackend {
 public:
  bool prepare(std::span<const DueSample> due, std::span<const Pose> poses) override;
  void record_measure(gpu::Batch&) override {}
  void add_copies(gpu::Batch&) override {}
  void collect(std::vector<base::ReadingBlock>& out) override;
  SensorStats stats() const override { return {}; }
  bool on_device() const override { return false; }

 protected:
  /// @param rows the kind's, as its `rows` gives them
  HostBackend(const SensorContext& context, const SensorType& kind, std::vector<SensorSpec> rows);

  /// Fills in readings. On any worker, each reading once and by itself.
  virtual void measure(std::span<const HostSample> samples) const = 0;

  std::span<const SensorSpec> rows() const { return rows_; }
  const world::World& world() const { return world_; }
  std::uint64_t seed() const { return seed_; }

 private:
  const world::World& world_;
  base::ThreadPool& thread_pool_;
  std::uint64_t seed_;
  std::uint8_t kind_;
  std::vector<SensorSpec> rows_;
  std::vector<std::size_t> first_;  ///< per row and one more: where its values begin
  std::vector<double> values_;
  std::vector<HostSample> samples_;
  bool recorded_ = false;
};

/// A sensor of a world, and whose it is.
struct MountedSensor {
  const world::Sensor& settings;
  SensorSpec row;  ///< as every sensor has it
};

/// Calls `body` for every sensor of `kind`, by mover and in file order.
/// @throws base::InputError for settings that no sensor can have, and what `body` throws.
void for_each_sensor(const world::World& world, const SensorType& kind, const std::function<void(MountedSensor)>& body);

}  // namespace sf::sensors
