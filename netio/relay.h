#pragma once
// Forwards states and signals from the farm: the newest V2V states of nearby robots to subscribed robots and to senders
// of V2I, those of all robots to a control centre, and START to the robots that it names. Sends once per tick, several
// states per datagram, within a budget, so that outgoing traffic does not grow with incoming traffic.
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
  double range = kV2vRange;     ///< [m] radius within which states are forwarded; 0: no states are forwarded
  std::size_t most = 64;        ///< number of nearest robots whose states one robot receives per tick
  std::size_t budget = 16'384;  ///< states sent to all robots per tick, divided evenly; at least Relay::kMinShare
};

struct RelayCounts {
  std::uint64_t states = 0;     ///< V2V states queued
  std::uint64_t datagrams = 0;  ///< NEIGHBOURS packets that contain them
  std::uint64_t waited = 0;     ///< pairs of robot and tick in which a subscriber was passed over for lack of budget
  std::uint64_t starts = 0;     ///< START datagrams queued
  std::uint64_t centre = 0;     ///< states queued for the control centre; part of `states`
  std::uint64_t missed = 0;     ///< states that the control centre did not receive for lack of budget
};

/// Single-threaded. Allocates nothing after construction.
class Relay {
 public:
  /// Minimum number of states per turn of a robot. If the budget does not suffice for all subscribers in one tick, they
  /// take turns, and each receives the states since its last turn.
  static constexpr std::size_t kMinShare = 4;

  /// @param robots ids of the world's robots
  /// @param lights ids of the world's intersections
  explicit Relay(std::span<const std::uint32_t> robots, const RelayOptions& options = {},
                 std::span<const std::uint32_t> lights = {});

  /// Keeps the newest V2V of each robot, START, and the positions of lights until the next `forward`. Ignores other
  /// packets.
  void take(const Packet& packet);

  /// Queues the new states for each subscriber and each light that is active at `now` [ns], to the address that it
  /// sends from. A robot does not receive its own state. Drops unused states.
  void forward(Inbox& inbox, std::int64_t now, Outbox& outbox);

  const RelayCounts& counts() const { return counts_; }
  /// Returns the number of places visited by the neighbour search.
  std::uint64_t visits() const { return neighbour_tree_.visits(); }

 private:
  struct Robot {
    std::uint32_t id = 0;
    std::uint32_t age = std::numeric_limits<std::uint32_t>::max();  ///< [passes] since its last state
    std::uint32_t waits = 0;                                        ///< [passes] since its turn, while it subscribes
    std::uint32_t sent = 0;                                         ///< NEIGHBOURS packets sent to it
    bool started = false;                                           ///< a START for this robot is pending
    std::optional<glm::dvec2> p;                                    ///< [m] its reported position
    base::Bytes state;
    base::Bytes start;
  };
  /// An intersection, which receives the states near its first light.
  struct Light {
    std::uint32_t id = 0;
    glm::dvec2 p{};  ///< [m]
    std::uint32_t sent = 0;
  };
  /// A receiver of NEIGHBOURS packets.
  struct Recipient {
    std::uint32_t id = 0;
    Endpoint address;
    SessionToken session_token;
    PacketSigner* signer = nullptr;
  };
  Robot* find(std::uint32_t id);
  void send_starts(Inbox& inbox, std::int64_t now, Outbox& outbox);
  void find_recipients(const Inbox& inbox, std::int64_t now);
  void send_states(Inbox& inbox, std::int64_t now, Outbox& outbox);
  void send_to_lights(Inbox& inbox, std::int64_t now, Outbox& outbox);
  void send_to_centre(Inbox& inbox, std::int64_t now, Outbox& outbox);
  void send_rows(std::span<const std::uint32_t> rows, const Recipient& to, std::uint32_t& sent, std::int64_t now,
                 Outbox& outbox);
  std::size_t send_others(Robot& to, std::size_t most, Inbox& inbox, std::int64_t now, Outbox& outbox);

  RelayOptions options_;
  std::vector<Robot> robots_;  ///< sorted by id
  std::vector<Light> lights_;
  std::vector<NeighbourTree::Place> updated_;  ///< in one pass
  std::vector<std::uint32_t> recipients_;      ///< rows, in one pass
  NeighbourTree neighbour_tree_;
  std::uint32_t turn_ = 0;                  ///< row served first
  std::uint32_t centre_turn_ = 0;           ///< row whose state the control centre receives first
  std::uint32_t sent_to_centre_ = 0;        ///< NEIGHBOURS packets
  std::vector<std::uint32_t> centre_rows_;  ///< in one pass
  bool start_pending_ = false;              ///< a START for all robots is pending
  base::Bytes start_;                       ///< START for all robots
  base::Bytes states_, packet_;
  RelayCounts counts_;
};

}  // namespace sf::netio
