#pragma once
// The order in which a farm delivers its readings, as a key of each reading. It allows merging parts of a fleet that
// different processes measure.

#include <compare>
#include <cstdint>
#include <vector>

#include "base/reading.h"
#include "sensors/sensor_set.h"

namespace sf::farm {

class ReadingOrder {
 public:
  /// Readings in ascending order of keys are in order of delivery, across all calls of `tick` and `sample`.
  struct Key {
    std::int64_t due = 0;    ///< [ns] time of the measurement and latency
    std::uint64_t rank = 0;  ///< among readings due at one time: late readings by robot, then others by type
    auto operator<=>(const Key&) const = default;  // NOLINT(modernize-use-nullptr): misread by clang-tidy 14
  };

  explicit ReadingOrder(const sensors::SensorSet& sensor_set);

  /// Returns the number of a reading's sensor among all sensors of the world, from 0.
  std::uint32_t sensor_of(std::uint8_t type, std::uint32_t mover, std::uint32_t sensor) const;
  std::uint32_t sensors() const { return static_cast<std::uint32_t>(sensors_.size()); }
  /// @param sensor number of the sensor @param time [ns] of the measurement
  Key key(std::uint32_t sensor, std::int64_t time) const {
    return {time + sensors_[sensor].latency, sensors_[sensor].rank};
  }
  bool is_late(std::uint32_t sensor) const { return sensors_[sensor].latency > 0; }

 private:
  struct Sensor {
    std::int64_t latency;  ///< [ns]
    std::uint64_t rank;
  };
  struct Type {
    std::uint32_t before = 0;          ///< number of sensors of types before this one
    std::vector<std::uint32_t> first;  ///< per mover: its first row
  };
  std::vector<Sensor> sensors_;
  std::vector<Type> types_;  ///< by id
};

}  // namespace sf::farm
