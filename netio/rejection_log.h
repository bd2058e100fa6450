#pragma once
// Reports senders whose datagrams a service drops: malformed ones, those with an unknown id, and those that never
// become valid (unproven, stale).

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "netio/endpoint.h"
#include "netio/packet_status.h"
#include "netio/rate_limited_log.h"

namespace sf::netio {

/// Returns the fault of a datagram and the remedy, as in "a V2V of 131 bytes is too short: expected 132".
/// @param robots ids of the world's robots
std::string rejection_text(PacketStatus reason, std::span<const std::uint8_t> bytes,
                           std::span<const std::uint32_t> robots);

/// Single-threaded. Allocates only for new senders, up to a limit.
class RejectionLog {
 public:
  static constexpr std::size_t kMaxRows = 256;  ///< pairs of sender and reason; further pairs share one row
  /// Well-behaved clients also send unproven and stale packets. They are reported only from this number in ten seconds
  /// on.
  static constexpr std::uint64_t kTolerated = 20;

  explicit RejectionLog(std::vector<std::uint32_t> robots) : robots_(std::move(robots)) {}

  /// Logs the first datagram of a sender and reason, then the number of datagrams every ten seconds while more arrive.
  /// Ignores reasons that SignatureTroubleLog reports. @param now [ns] of any clock that does not decrease
  void note(PacketStatus reason, std::span<const std::uint8_t> bytes, const Endpoint& who, std::int64_t now,
            RateLimitedLog& log);

 private:
  RepeatedEvent& row_of(const Endpoint& who, PacketStatus reason, std::int64_t now);

  std::vector<std::uint32_t> robots_;
  std::map<std::tuple<std::uint32_t, std::uint16_t, PacketStatus>, RepeatedEvent>
      rows_;  ///< keyed by address, port and reason
  RepeatedEvent others_;
};

}  // namespace sf::netio
