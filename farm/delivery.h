#pragma once
// Latency: a reading is measured now and delivered later.

#include <cstdint>
#include <span>
#include <vector>

#include "base/reading.h"
#include "farm/schedule.h"
#include "farm/stored_reading.h"
#include "sensors/sensor_set.h"

namespace sf::farm {

/// Holds back the readings of sensors with a latency. Sensors without one cost nothing here.
class Delivery {
 public:
  /// `sensor_set` must outlive it.
  explicit Delivery(const sensors::SensorSet& sensor_set);

  /// Takes what was measured at `now` [ns] and gives what is delivered at `now`: first what waited, oldest first, then
  /// what has no latency. Blocks live until the next call.
  std::span<const base::ReadingBlock> deliver(std::int64_t now, std::span<const base::ReadingBlock> measured);

  /// [ns] When the next of those that wait is due; kNever: none does.
  std::int64_t next() const { return next_; }

 private:
  struct Waiting {
    StoredReading reading;
    std::int64_t due = 0;
    bool used = false;
  };
  std::int64_t latency_of(const base::ReadingBlock& block) const;
  void hold(const base::ReadingBlock& block, std::int64_t due);

  const sensors::SensorSet& sensor_set_;
  bool any_ = false;
  std::int64_t next_ = kNever;
  std::vector<Waiting> waiting_;  ///< places are reused, with their memory
  std::vector<Waiting*> ready_;
  std::vector<Waiting*> last_delivered_;  ///< delivered last time, free from now on
  std::vector<base::ReadingBlock> delivered_;
};

}  // namespace sf::farm
