#pragma once
// The farm passes on states and signals: to robots that asked for others' states the newest V2V of the robots near
// them, START to the robots that it names. Once per tick, many states a datagram, within a budget: traffic out does not
// grow with traffic in.
//
//   relay.take(packet);                        // each packet that the inbox accepted
//   relay.forward(inbox, now, outbox);         // each tick; then outbox.flush()

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "netio/inbox.h"
#include "netio/neighbour_tree.h"
#include "netio/outbox.h"
#include "netio/packets.h"

namespace sf::netio {

struct RelayOptions {
  double range = kV2vRange;     ///< [m] farther away, states are not passed on; 0: none is
  std::size_t most = 64;        ///< states to one robot per tick, of the nearest
  std::size_t budget = 16'384;  ///< states to all robots per tick, shared alike; at least Relay::kMinShare
};

struct RelayCounts {
  std::uint64_t states = 0;     ///< V2V queued
  std::uint64_t datagrams = 0;  ///< NEIGHBOURS that they were queued in
  std::uint64_t waited = 0;     ///< robot and tick: it asked, and the budget was spent
  std::uint64_t starts = 0;     ///< START datagrams queued
};

/// One thread. Nothing is allocated after construction.
class Relay {
 public:
  /// States that a robot is passed in its turn, however many ask. Where the budget does not serve all in one tick they
  /// take turns, and each is passed what was said since its last one.
  static constexpr std::size_t kMinShare = 4;

  /// @param robots ids that the world has
  explicit Relay(std::span<const std::uint32_t> robots, const RelayOptions& options = {});

  /// Keeps a V2V of one of the robots, or a START, until the next `forward`: the newest of each. Others are left out.
  void take(const Packet& packet);

  /// Queues what came since the last time, to where each robot that is heard at `now` [ns] sends from; a robot is not
  /// sent its own state. What nobody wanted is forgotten.
  void forward(const Inbox& inbox, std::int64_t now, Outbox& outbox);

  const RelayCounts& counts() const { return counts_; }
  /// Places that the search for neighbours looked at.
  std::uint64_t visits() const { return neighbour_tree_.visits(); }

 private:
  struct Robot {
    std::uint32_t id = 0;
    std::uint32_t age = std::numeric_limits<std::uint32_t>::max();  ///< [passes] since it spoke
    std::uint32_t waits = 0;                                        ///< [passes] since its turn, while it asks
    std::uint32_t sent = 0;                                         ///< NEIGHBOURS to it
    bool started = false;                                           ///< a START for it alone waits
    std::optional<glm::dvec2> p;                                    ///< [m] where it said it is
    base::Bytes state;
    base::Bytes start;
  };
  Robot* find(std::uint32_t id);
  void send_starts(const Inbox& inbox, std::int64_t now, Outbox& outbox);
  void find_recipients(const Inbox& inbox, std::int64_t now);
  void send_states(const Inbox& inbox, std::int64_t now, Outbox& outbox);
  std::size_t send_others(Robot& to, std::size_t most, const Inbox& inbox, std::int64_t now, Outbox& outbox);

  RelayOptions options_;
  std::vector<Robot> robots_;                  ///< by id
  std::vector<NeighbourTree::Place> updated_;  ///< of one pass
  std::vector<std::uint32_t> recipients_;      ///< rows, of one pass
  NeighbourTree neighbour_tree_;
  std::uint32_t turn_ = 0;      ///< row that is served first
  bool start_pending_ = false;  ///< a START for everyone waits
  base::Bytes start_;           ///< that one
  base::Bytes states_, packet_;
  RelayCounts counts_;
};

}  // namespace sf::netio
