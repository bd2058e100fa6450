#pragma once
// Hash of readings that several processes measure in parts. It equals the hash of a single process.

#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/reading.h"
#include "farm/reading_order.h"

namespace sf::farm {

/// Collects the hashes of one process' readings, call by call, and chains those of all processes. All processes make
/// the same calls at the same times. Bytes: for each call the number of readings, then a sensor and a hash for each
/// reading, and the time of late readings.
class SharedHash {
 public:
  explicit SharedHash(const sensors::SensorSet& sensor_set) : order_(sensor_set) {}

  /// Call this after the fleet has gained sensors.
  void add_sensors(const sensors::SensorSet& sensor_set) { order_ = ReadingOrder(sensor_set); }
  /// Adds a call's readings. @param now [ns] @param hashes one per reading
  void add_call(std::int64_t now, std::span<const base::ReadingBlock> readings, std::span<const std::uint64_t> hashes);
  /// Writes all calls since the last `write`.
  void write(base::Bytes& out);
  /// Chains the calls of all processes since the last `chain`, from their written bytes.
  /// @param parts one reader per process, at its calls; out: after them @return the hash of all calls so far
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
