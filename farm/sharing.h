#pragma once
// A farm's part of a fleet that several processes sense together (FarmOptions::shared, Farm::sharing).

#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/reading.h"
#include "farm/reading_exchange.h"
#include "farm/shared_hash.h"

namespace sf::farm {

/// Initially this process measures all sensors and delivers all readings. Not thread-safe.
class Sharing {
 public:
  Sharing(const sensors::SensorSet& sensor_set, std::size_t movers);

  /// Leaves the mover's sensors to another process, which measures them and delivers their readings. They remain due
  /// here, as far as `Farm::next_due` and the numbers of readings are concerned.
  void leave_to_others(std::uint32_t mover);
  /// Sets whether this process measures the mover's subscribed sensors, whichever process delivers their readings.
  void set_measured_here(std::uint32_t mover, bool here);
  /// Hides a mover whose pose only another process has: no sensor here detects it until it is shown again. The first
  /// report after that sets its pose.
  void set_hidden(std::uint32_t mover, bool hidden) { hidden_.at(mover) = hidden ? 1 : 0; }
  /// Passes readings from the process that measures them to the process that delivers them. @param exchange must
  /// outlive the farm; null: none
  void set_exchange(ReadingExchange* exchange) { exchange_ = exchange; }

  /// Writes the hashes of this process' readings since the last call, for the other processes (farm/shared_hash.h).
  void write_hashes(base::Bytes& out) { hashes_.write(out); }
  /// Chains the hashes of all processes. @param parts one reader per process, at the bytes of its `write_hashes`; out:
  /// after them
  void add_hashes(std::span<base::ByteReader> parts) { hash_ = hashes_.chain(parts); }
  /// Returns the hash of the readings chained so far.
  std::uint64_t hash() const { return hash_; }

  // For use by the farm:

  void subscribe(std::uint32_t mover, base::SensorTypes types);
  /// Call this after the world has gained one mover, in its last row.
  void add_mover(const sensors::SensorSet& sensor_set);
  bool is_hidden(std::uint32_t mover) const { return hidden_[mover] != 0; }
  ReadingExchange* exchange() const { return exchange_; }
  /// Returns per mover the subscribed sensor types that are measured here, or delivered here.
  std::span<const base::SensorTypes> measured_types() const { return measured_types_; }
  std::span<const base::SensorTypes> delivered_types() const { return delivered_types_; }
  void add_call(std::int64_t now, std::span<const base::ReadingBlock> readings, std::span<const std::uint64_t> hashes) {
    hashes_.add_call(now, readings, hashes);
  }

 private:
  // Per mover.
  std::vector<std::uint8_t> measures_, delivers_, hidden_;
  std::vector<base::SensorTypes> types_, measured_types_, delivered_types_;
  ReadingExchange* exchange_ = nullptr;
  SharedHash hashes_;
  std::uint64_t hash_ = 0;
};

}  // namespace sf::farm
