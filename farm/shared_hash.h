#pragma once
// The hash of readings that several processes measure, each a part of them: equal to that of one process.

#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/reading.h"
#include "farm/reading_order.h"

namespace sf::farm {

/// Collects the hashes of one process' readings, call by call, and chains those of all processes. All make the same
/// calls at the same times. Bytes: per call their number, then a sensor and a hash each, and the time of late readings.
class SharedHash {
 public:
  explicit SharedHash(const sensors::SensorSet& sensor_set) : order_(sensor_set) {}

  /// The fleet has got more sensors.
  void add_sensors(const sensors::SensorSet& sensor_set) { order_ = ReadingOrder(sensor_set); }
  /// Adds a call's readings. @param now [ns] @param hashes one per reading
  void add_call(std::int64_t now, std::span<const base::ReadingBlock> readings, std::span<const std::uint64_t> hashes);
  /// Writes all calls since the last `write`.
  void write(base::Bytes& out);
  /// Chains the calls of all processes since the last `chain`, from what they wrote.
  /// @param parts one reader per process, at its calls; out: behind them @return the hash of all calls so far
  std::uint64_t chain(std::span<base::ByteReader> parts);

 private:
  struct Entry {
    ReadingOrder::Key key;
    std::uint64_t hash;
    bool operator<(const Entry& other) const { return key < other.key; }
  };
  void read_call(base::ByteReader& in);

  ReadingOrder order_;
  base::Bytes calls_;
  std::uint32_t count_ = 0;
  std::vector<Entry> entries_;
  std::vector<std::uint64_t> hashes_;
  std::uint64_t hash_ = 0;
};

}  // namespace sf::farm
