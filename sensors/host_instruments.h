#pragma once
// Instruments of kinds that need no device: whatever is due is read on the host, by all workers.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sensors/kind.h"

namespace sf::sensors {

/// One reading to be taken.
struct Sight {
  std::uint32_t row = 0;       ///< in the kind's rows of this world
  std::uint64_t sequence = 0;  ///< names its noise
  Pose X_WS;                   ///< the sensor's; z: its height in the world as it was at load, the world being 2.5-D
  std::span<double> values;    ///< of all rows and columns, to be filled
};

/// All sensors of one kind that needs no device. One thread.
class HostInstruments : public Instruments {
 public:
  bool prepare(std::span<const DueSample> due, std::span<const Pose> poses) override;
  void record_measure(gpu::Batch&) override {}
  void add_copies(gpu::Batch&) override {}
  void collect(std::vector<base::ReadingBlock>& out) override;
  SensorStats stats() const override { return {}; }
  bool on_device() const override { return false; }

 protected:
  /// @param rows the kind's, as its `rows` gives them
  HostInstruments(const SensorContext& context, const SensorKind& kind, std::vector<SensorRow> rows);

  /// Fills in readings. On any worker, each reading once and by itself.
  virtual void measure(std::span<const Sight> sights) const = 0;

  std::span<const SensorRow> rows() const { return rows_; }
  const world::World& world() const { return world_; }
  std::uint64_t seed() const { return seed_; }

 private:
  const world::World& world_;
  base::ThreadPool& thread_pool_;
  std::uint64_t seed_;
  std::uint8_t kind_;
  std::vector<SensorRow> rows_;
  std::vector<std::size_t> first_;  ///< per row and one more: where its values begin
  std::vector<double> values_;
  std::vector<Sight> sights_;
  bool recorded_ = false;
};

/// A sensor of a world, and whose it is.
struct Fitted {
  const world::Sensor& settings;
  SensorRow row;  ///< as every sensor has it
};

/// Calls `body` for every sensor of `kind`, by mover and in file order.
/// @throws base::InputError for settings that no sensor can have, and what `body` throws.
void for_each_sensor(const world::World& world, const SensorKind& kind, const std::function<void(Fitted)>& body);

}  // namespace sf::sensors
