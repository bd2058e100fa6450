#pragma once
// What the farm passes on: every robot's newest V2V to those that asked for others' states, START to whom it is meant
// for. Once per tick, so that nobody makes it send more by sending more.
//
//   relay.take(packet);                        // each packet that the inbox accepted
//   relay.pass_on(inbox, now, outbox);         // each tick; then outbox.flush()

#include <cstdint>
#include <span>
#include <vector>

#include "netio/inbox.h"
#include "netio/outbox.h"
#include "netio/packets.h"

namespace sf::netio {

struct RelayCounts {
  std::uint64_t states = 0;  ///< V2V datagrams queued
  std::uint64_t starts = 0;  ///< START datagrams queued
};

/// One thread. Nothing is allocated after construction.
class Relay {
 public:
  /// @param robots ids that the world has
  explicit Relay(std::span<const std::uint32_t> robots);

  /// Keeps a V2V of one of the robots, or a START, until the next `pass_on`: the newest of each. Others are left out.
  void take(const Packet& packet);

  /// Queues what came since the last time, to where each robot that is heard at `now` [ns] sends from; a robot is not
  /// sent its own state. What nobody wanted is forgotten.
  void pass_on(const Inbox& inbox, std::int64_t now, Outbox& outbox);

  const RelayCounts& counts() const { return counts_; }

 private:
  struct Robot {
    std::uint32_t id = 0;
    bool spoke = false;    ///< since the last pass
    bool started = false;  ///< a START for it waits
    base::Bytes state;
    base::Bytes start;
  };
  Robot* find(std::uint32_t id);
  void send_others(const Robot& to, const Endpoint& where, const Stamp& stamp, Outbox& outbox);

  std::vector<Robot> robots_;       ///< by id
  std::vector<std::size_t> spoke_;  ///< rows, of one pass
  RelayCounts counts_;
};

}  // namespace sf::netio
