#pragma once
// Latency: readings are measured at one time and delivered later.

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "base/reading.h"
#include "farm/copy_calls.h"
#include "farm/faults.h"
#include "farm/schedule.h"
#include "farm/stored_reading.h"
#include "sensors/sensor_set.h"

namespace sf::farm {

/// Delays the readings of sensors with a latency, or delayed by a fault. Without such sensors `deliver` returns its
/// argument.
class Delivery {
 public:
  /// @param faults delay readings further; null: none. Both must outlive it.
  explicit Delivery(const sensors::SensorSet& sensor_set, const Faults* faults = nullptr,
                    const raycast::Episodes& episodes = {});

  /// Call this after the sensor set has gained sensors.
  void add_sensors();

  /// Takes the readings measured at `now` [ns] and returns those delivered at `now`: first the delayed ones, in order
  /// of their delivery times, then those without latency. Blocks are valid until the next call.
  /// @param calls delayed readings of copies that do not take part remain delayed
  std::span<const base::ReadingBlock> deliver(std::int64_t now, std::span<const base::ReadingBlock> measured,
                                              const CopyCalls& calls = CopyCalls({}));

  /// Delays a reading of a sensor with latency until a later call of `deliver`. @return false if it has none
  bool hold_if_late(const base::ReadingBlock& block);

  /// [ns] Returns the time from measurement to delivery.
  std::int64_t latency_of(const base::ReadingBlock& block) const;
  /// [ns] Returns the farm's time of the delivery.
  std::int64_t time_of(const base::ReadingBlock& block) const {
    return episodes_.start_of(block.mover) + block.time + latency_of(block);
  }

  /// Drops the delayed readings of movers [first, end).
  void drop(std::uint32_t first, std::uint32_t end);

  /// Returns the delivery time [ns] of the next delayed reading; kNever: no reading is waiting.
  std::int64_t next() const { return next_; }

 private:
  struct Waiting {
    StoredReading reading;
    std::int64_t due = 0;
    bool used = false;
  };
  void hold(const base::ReadingBlock& block, std::int64_t due);

  const sensors::SensorSet& sensor_set_;
  const Faults* faults_;
  raycast::Episodes episodes_;
  bool any_ = false;
  std::int64_t next_ = kNever;
  std::deque<Waiting> waiting_;  ///< slots are reused with their memory, at fixed addresses
  std::vector<Waiting*> ready_;
  std::vector<Waiting*> last_delivered_;  ///< their slots are freed at the next call
  std::vector<base::ReadingBlock> delivered_;
};

}  // namespace sf::farm
