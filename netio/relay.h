#pragma once
// What the farm passes on: to those that asked for others' states the newest V2V of the robots near them, START to whom
// it is meant for. Once per tick, many states a datagram, within a budget: nobody makes it send more by sending more.
//
//   relay.take(packet);                        // each packet that the inbox accepted
//   relay.pass_on(inbox, now, outbox);         // each tick; then outbox.flush()

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "netio/inbox.h"
#include "netio/nearby.h"
#include "netio/outbox.h"
#include "netio/packets.h"

namespace sf::netio {

struct RelayOptions {
  double range = 50.0;         ///< [m] states of robots farther away are not passed on
  std::size_t most = 64;       ///< states to one robot per tick: of the nearest
  std::size_t budget = 16384;  ///< states to all robots per tick, shared alike; at least kLeastShare to those served
};

struct RelayCounts {
  std::uint64_t states = 0;     ///< V2V queued
  std::uint64_t datagrams = 0;  ///< that they were queued in
  std::uint64_t starts = 0;     ///< START datagrams queued
  std::uint64_t waited = 0;     ///< times that a robot which asked was passed over: the budget was spent
};

/// One thread. Nothing is allocated after construction.
class Relay {
 public:
  /// States that a robot is passed whose turn it is, however many ask: more robots than the budget serves take turns.
  static constexpr std::size_t kLeastShare = 4;

  /// @param robots ids that the world has
  explicit Relay(std::span<const std::uint32_t> robots, const RelayOptions& options = {});

  /// Keeps a V2V of one of the robots, or a START, until the next `pass_on`: the newest of each. Others are left out.
  void take(const Packet& packet);

  /// Queues what came since the last time, to where each robot that is heard at `now` [ns] sends from; a robot is not
  /// sent its own state. What nobody wanted is forgotten.
  void pass_on(const Inbox& inbox, std::int64_t now, Outbox& outbox);

  const RelayCounts& counts() const { return counts_; }

 private:
  struct Robot {
    std::uint32_t id = 0;
    bool spoke = false;           ///< since the last pass
    bool started = false;         ///< a START for it waits
    std::uint32_t sent = 0;       ///< datagrams of others' states
    std::optional<base::Vec2> p;  ///< [m] where it said it is
    base::Bytes state;
    base::Bytes start;
  };
  Robot* find(std::uint32_t id);
  void send_starts(const Inbox& inbox, std::int64_t now, Outbox& outbox);
  void send_others(std::uint32_t row, std::size_t most, const Endpoint& where, std::int64_t now, Outbox& outbox);

  RelayOptions options_;
  std::vector<Robot> robots_;          ///< by id
  std::vector<Nearby::Place> spoke_;   ///< of one pass
  std::vector<std::uint32_t> askers_;  ///< rows, of one pass
  Nearby nearby_;
  std::uint32_t turn_ = 0;  ///< row that is served first
  base::Bytes states_, packet_;
  RelayCounts counts_;
};

}  // namespace sf::netio
