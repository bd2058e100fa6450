#pragma once
// V2V between robots without the farm: sends a robot's states, and its map to its team, to a list of addresses and to a
// multicast group, and receives those of other robots. docs/packets.md specifies the accepted packets.
//
//   DirectV2v direct({.peers = {{address, port}}, .robot = 7, .others = ids});
//   direct.set_position({x, y});
//   direct.send(bytes);                                                       // an encoded V2V or TEAM_MAP
//   direct.receive(now, [&](std::span<const std::uint8_t> bytes) { ... });
//   if (direct.admit(header, now)) ...                                        // also for states relayed by the farm
//
// Single-threaded. Reads no clock.

#include <glm/vec2.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "netio/address_token.h"
#include "netio/endpoint.h"
#include "netio/outbox.h"
#include "netio/packet_status.h"
#include "netio/packets.h"
#include "netio/peers.h"
#include "netio/rate_limited_log.h"
#include "netio/rejection_log.h"
#include "netio/sender_bindings.h"
#include "netio/signature.h"
#include "netio/socket.h"

namespace sf::netio {

/// Returns whether the address is that of a multicast group (224.0.0.0/4).
inline bool is_multicast(std::uint32_t address) { return address >> 28 == 0xE; }

struct DirectV2vOptions {
  Endpoint bind;                        ///< where to receive, and the source of sent packets; port 0: any free port
  std::vector<Endpoint> peers;          ///< receivers of each state; may include this robot
  std::optional<Endpoint> group;        ///< multicast group to send to and to join; its port differs from `bind`
  std::uint32_t interface_address = 0;  ///< of the interface for the group; 0: by the route
  double radio = kV2vRange;             ///< [m] > 0 states of robots farther away are ignored
  std::uint32_t robot = 0;              ///< id of this robot
  std::vector<std::uint32_t> others;    ///< ids of the world's other robots
  std::vector<Peer> table;              ///< addresses and keys of robots, and the key of the group
  std::uint32_t session = random_session();
  std::size_t receive_buffer = 1u << 20;
  int log_descriptor = -1;  ///< of messages about dropped packets; -1: none
};

/// Each received datagram is counted once.
struct DirectV2vCounts {
  OutboxCounts sent;             ///< per receiver
  PacketCounts packets;          ///< received; accepted: new states and TEAM_MAP
  std::uint64_t duplicates = 0;  ///< datagrams received before, and states, also relayed ones, that arrived by the
                                 ///< other way before or were overtaken there
  std::uint64_t far = 0;         ///< from robots beyond radio range, and TEAM_MAP without a recent state
  std::uint64_t own = 0;         ///< from this robot, returned by the network
  std::uint64_t over_rate = 0;   ///< dropped without a check, because too many arrived
  std::uint64_t socket_drops = 0;
  std::uint64_t lines_left_out = 0;  ///< dropped from the log
};

class DirectV2v {
 public:
  /// [ns] of silence after which an unsigned sender at the same IP address counts as restarted.
  static constexpr std::int64_t kRestart = 500'000'000;
  static constexpr std::size_t kMaxReceivers = 1024;    ///< addresses in `DirectV2vOptions::peers`
  static constexpr std::size_t kMaxPerPeriod = 10'000;  ///< datagrams checked in each 0.1 s
  static constexpr std::size_t kMaxPerCall = 65'536;    ///< datagrams taken from each socket by one `receive`

  /// @throws PortInUse
  /// @throws base::InputError for an address that is not this machine's, a group that is not multicast or cannot be
  /// joined, a multicast address among `peers`, or too many of them
  explicit DirectV2v(const DirectV2vOptions& options);

  /// Sets the robot's position [m], from which the radio range is measured. Without one, states of any distance are
  /// accepted.
  void set_position(const glm::dvec2& p) { p_ = p; }

  /// Sends an encoded V2V or TEAM_MAP with this robot's session to all receivers, signed once if there is a key.
  void send(std::span<const std::uint8_t> bytes);

  /// Passes the waiting datagrams with acceptable states and maps of other robots to `take(std::span<const
  /// std::uint8_t> bytes)`. A map is acceptable from a robot whose state was accepted in the last two seconds.
  /// @param now [ns] of any clock that does not decrease
  template <class Take>
  void receive(std::int64_t now, Take&& take) {
    begin_period(now);
    const auto one = [&](std::span<const std::uint8_t> bytes, const Endpoint& source) {
      if (accept(bytes, source, now)) take(bytes);
    };
    batch_.drain(socket_, kMaxPerCall, one);
    if (options_.group) batch_.drain(group_, kMaxPerCall, one);
  }

  /// Returns whether a state, received directly or relayed by the farm, is newer than all states of its robot before.
  /// Otherwise it counts as a duplicate. After a restart of the robot that was noticed directly, only direct states are
  /// newer for two seconds: relayed ones may be from before. A robot that restarts its count is otherwise accepted
  /// after two seconds of silence.
  bool admit(const Header& header, std::int64_t now);

  /// Returns whether a state of `robot` was admitted less than two seconds before `now`.
  bool is_active(std::uint32_t robot, std::int64_t now) const { return newest_.is_active(robot, now); }

  /// Sleeps until one of the sockets is readable, a packet arrives here, or `timeout_ms` >= 0 has passed.
  void wait(const Socket& one, const Socket& other, int timeout_ms) const;

  std::uint16_t port() const { return bound_endpoint(socket_).port; }
  const DirectV2vOptions& options() const { return options_; }
  DirectV2vCounts counts() const;

 private:
  /// Another robot of the world.
  struct Sender {
    std::optional<std::uint32_t> address;       ///< from the table
    std::optional<SignatureChecker> checker;    ///< with the key of the group or of the robot
    std::uint32_t session = 0;                  ///< of its last accepted state
    std::uint32_t sequence = 0;                 ///< the same
    std::optional<std::uint32_t> map_sequence;  ///< of its last accepted TEAM_MAP in this session
    std::int64_t last = 0;                      ///< [ns] when its last packet was accepted
    std::optional<std::int64_t> last_state;     ///< [ns] when its last state was accepted
    std::uint32_t session_before = 0;           ///< the session that this one replaced
    std::optional<std::int64_t> restarted;      ///< [ns] when it did
  };
  bool accept(std::span<const std::uint8_t> bytes, const Endpoint& source, std::int64_t now);
  PacketStatus check_sender(const Packet& packet, std::span<const std::uint8_t> bytes, const Endpoint& source);
  PacketStatus bind_sender(const Header& header, const Endpoint& source, std::int64_t now);
  bool has_restarted(const Header& header, const Endpoint& source, std::int64_t now) const;
  bool is_repeated(const Header& header, std::int64_t now) const;
  bool is_far(const Packet& packet, std::int64_t now) const;
  bool is_over_rate(std::int64_t now);
  void begin_period(std::int64_t now);
  void note(PacketStatus status, std::span<const std::uint8_t> bytes, const Endpoint& source, std::int64_t now);

  DirectV2vOptions options_;
  Socket socket_;  ///< sends all packets, receives those to its own address
  Socket group_;   ///< receives those to the group; not open without one
  Outbox outbox_;
  ReceiveBatch batch_;
  SenderBindings senders_;       ///< of direct packets, by source; signed ones count as of one source
  SenderBindings newest_;        ///< of direct and relayed states
  std::vector<Sender> details_;  ///< per row of `senders_`
  std::optional<PacketSigner> signer_;
  std::optional<glm::dvec2> p_;    ///< [m]
  std::int64_t period_start_ = 0;  ///< [ns]
  std::size_t checked_ = 0;        ///< datagrams in that period
  base::Bytes packet_;
  DirectV2vCounts counts_;
  RateLimitedLog log_;
  RejectionLog rejections_;
  std::map<std::pair<std::uint32_t, PacketStatus>, RepeatedEvent> refused_;  ///< by robot of the world and reason
  RepeatedEvent flood_;
};

}  // namespace sf::netio
