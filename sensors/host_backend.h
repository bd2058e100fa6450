#pragma once
// Base class of sensor backends without device work. All pool threads compute readings on the host.

#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

/// One reading to be measured.
struct HostSample {
  std::uint32_t row = 0;       ///< row among the sensor type's sensors in this world
  std::uint64_t sequence = 0;  ///< key of the reading's noise
  Pose X_WS;                   ///< pose of the sensor
  std::span<double> values;    ///< all rows and columns, to be filled in
};

/// All sensors of one type without device work. Not thread-safe.
class HostBackend : public SensorBackend {
 public:
  bool prepare(std::span<const DueSample> due) override;
  void record_measure(gpu::Batch&) override {}
  void add_copies(gpu::Batch&) override {}
  void collect(std::span<base::ReadingBlock> out) override;
  SensorStats stats() const override { return {}; }
  bool on_device() const override { return false; }

 protected:
  HostBackend(const SensorContext& context, const SensorType& type, const ParsedSensors& sensors);

  /// Fills in all due readings. The default calls `measure` on all pool threads.
  virtual void measure_all();
  /// Fills in readings. Several pool threads call it concurrently, each reading exactly once.
  virtual void measure(std::span<const HostSample> /*samples*/) const {}

  std::span<const SensorSpec> rows() const { return rows_; }
  /// Returns the due readings, since `prepare`.
  std::span<const HostSample> samples() const { return samples_; }
  /// Returns the index of a sensor's first value among those of all rows; for the number of rows, their count.
  std::size_t first_value(std::size_t row) const { return first_[row]; }
  base::ThreadPool& thread_pool() const { return thread_pool_; }
  const world::World& world() const { return world_; }
  std::span<const base::Report> states() const { return states_; }
  const raycast::Episodes& episodes() const { return episodes_; }

 private:
  const world::World& world_;
  base::ThreadPool& thread_pool_;
  std::span<const base::Report> states_;
  raycast::Episodes episodes_;
  std::uint8_t type_;
  std::span<const SensorSpec> rows_;
  std::vector<std::size_t> first_;  ///< per row, plus one: index of its first value
  std::vector<double> values_;
  std::vector<HostSample> samples_;
  bool recorded_ = false;
};

/// A sensor of a world, with its spec.
struct MountedSensor {
  const world::Sensor& settings;
  SensorSpec row;  ///< settings common to all types
};

/// Calls `body` for every sensor of `type`, by mover and in file order.
/// @throws base::InputError for invalid common settings, and exceptions of `body`
void for_each_sensor(const world::World& world, const SensorType& type, const std::function<void(MountedSensor)>& body);

/// Parses the sensors of a type.
/// @param read (const world::Sensor&, SensorSpec& row): returns the sensor's further settings, and sets the fields of
/// its
///             row that are special to the type
template <class Read>
ParsedSensors parse_each(const world::World& world, const SensorType& type, const Read& read) {
  std::vector<SensorSpec> rows;
  std::vector<std::invoke_result_t<Read, const world::Sensor&, SensorSpec&>> settings;
  for_each_sensor(world, type, [&](MountedSensor mounted) {
    settings.push_back(read(mounted.settings, mounted.row));
    rows.push_back(mounted.row);
  });
  return {std::move(rows), std::move(settings)};
}

}  // namespace sf::sensors
