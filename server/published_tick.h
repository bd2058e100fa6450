#pragma once
// The tick that a lockstep published last: states of all movers and the newest reading of each sensor.

#include <cstdint>
#include <optional>
#include <vector>

#include "base/tick_record.h"
#include "farm/stored_reading.h"
#include "sensors/sensor_set.h"

namespace sf::server {

/// Not thread-safe. The sensor set must outlive it.
class PublishedTick {
 public:
  explicit PublishedTick(const sensors::SensorSet& sensor_set);

  void take(const base::TickRecord& record);

  std::uint64_t tick() const { return tick_; }
  std::int64_t time() const { return time_; }  ///< [ns] simulated
  const base::Report& report(std::uint32_t mover) const { return reports_[mover]; }
  bool contact(std::uint32_t mover) const { return contacts_[mover] != 0; }

  /// Appends the rows of the mover's sensors with a reading delivered after tick `after` (nullopt: ever), ordered by
  /// type and sensor.
  /// @param types bit k: sensor type with wire id k
  void find_new(std::uint32_t mover, base::SensorTypes types, std::optional<std::uint64_t> after,
                std::vector<std::uint32_t>& rows) const;
  /// Returns the newest reading of a row found by `find_new`.
  const base::ReadingBlock& reading(std::uint32_t row) const { return newest_[row].reading.block(); }

 private:
  struct Newest {
    farm::StoredReading reading;
    std::optional<std::uint64_t> tick;  ///< of its delivery; nullopt: never delivered
  };
  std::uint32_t row_of(const base::ReadingBlock& reading) const;

  const sensors::SensorSet& sensor_set_;
  std::vector<std::uint32_t> first_;  ///< first row per group of sensors
  std::vector<Newest> newest_;        ///< per sensor
  std::vector<base::Report> reports_;
  std::vector<std::uint8_t> contacts_;
  std::uint64_t tick_ = 0;
  std::int64_t time_ = 0;
};

}  // namespace sf::server
