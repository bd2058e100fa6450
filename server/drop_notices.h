#pragma once
// Tells robots which of their readings the budgets of `serve` dropped (DROPPED packets).

#include <cstdint>
#include <map>
#include <utility>

#include "base/bytes.h"
#include "netio/packets.h"
#include "server/state_receiver.h"

namespace sf::server {

/// Not thread-safe.
class DropNotices {
 public:
  static constexpr std::int64_t kPeriod = 250'000'000;    ///< [ns] between two notices about a sensor
  static constexpr std::int64_t kRepeat = 1'000'000'000;  ///< [ns] after which the last one is repeated once

  enum class Reason : std::uint8_t { processor, network };
  /// Counts a reading. @param robot id @param time [ns] of the reading
  void add(std::uint32_t robot, std::uint8_t type, std::uint32_t sensor, Reason reason, std::int64_t time);
  /// Sends the notices that are due to active robots.
  void publish(std::int64_t now, StateReceiver& receiver);

 private:
  struct Sensor {
    netio::Dropped counts;
    std::int64_t time = 0;  ///< [ns] of the newest reading that was dropped
    bool news = false, repeated = true;
    std::int64_t sent = -kPeriod;
  };
  using Key = std::pair<std::uint8_t, std::uint32_t>;       // type, sensor
  std::map<std::uint32_t, std::map<Key, Sensor>> sensors_;  ///< by robot id
  std::map<std::uint32_t, std::uint32_t> sequences_;        ///< by robot id
  base::Bytes packet_;
};

}  // namespace sf::server
