#pragma once
// Simulates the radio between robots: each receives the others' broadcasts late, or not at all.

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "base/report.h"
#include "base/state_quality.h"
#include "netio/link_model.h"

namespace sf::scenarios {

struct V2vLinkOptions {
  double rate = 10.0;     ///< [Hz] > 0, broadcasts of every robot, at most one per tick
  double forget = 1.0;    ///< [s] >= 0 after the last possible arrival of a broadcast, a silent robot is unknown
  netio::LinkModel link;  ///< of every broadcast to every receiver
};

struct Broadcast {
  base::Report state;  ///< a received one is extrapolated from its arrival to the present, as `robot` does
  base::Intent intent;
  base::StateQuality quality = {};  ///< of an estimated state; not stated: it is the true state
};

/// The latest broadcasts of a fleet. Arrivals are drawn per receiver, sender and broadcast, and do not depend on the
/// order of calls.
class V2vLink {
 public:
  static constexpr double kMostKept = 1e7;  ///< broadcasts of all robots

  /// @throws base::InputError if more than `kMostKept` broadcasts of `movers` robots would be kept
  V2vLink(const V2vLinkOptions& options, std::size_t movers);

  /// Sends the broadcasts at `time` [ns], if due.
  /// @param broadcasts one per mover @param absent per mover: sends nothing
  void send(std::int64_t time, std::span<const Broadcast> broadcasts, const std::vector<bool>& absent);

  /// Ids of two robots in packets.
  struct Ids {
    std::uint32_t receiver = 0;
    std::uint32_t sender = 0;
  };
  /// Returns the newest broadcast of `sender` that has reached `receiver` by `time` [ns], no earlier than the last
  /// `send`; nullopt: none, or all are forgotten. Thread-safe with respect to itself.
  /// @param sender row of the mover
  std::optional<Broadcast> receive(std::int64_t time, std::uint32_t sender, const Ids& ids) const;
  /// The same as it was sent, with the times of sending and arrival [ns].
  struct Arrived {
    const Broadcast& broadcast;  ///< valid until the next `send`
    std::int64_t sent = 0, arrived = 0;
  };
  std::optional<Arrived> newest(std::int64_t time, std::uint32_t sender, const Ids& ids) const;

 private:
  struct Message {
    bool sent = false;
    Broadcast broadcast;
  };
  struct Round {
    std::int64_t time = 0;
    std::uint64_t sequence = 0;
    std::vector<Message> messages;  ///< per mover
  };

  V2vLinkOptions options_;
  std::int64_t kept_;         ///< [ns]
  std::uint64_t sent_ = 0;    ///< rounds
  std::deque<Round> rounds_;  ///< oldest first
};

}  // namespace sf::scenarios
