#pragma once
// A robot's own end of V2V: one socket that it speaks to the farm from, and hears others on.
//
//   V2vSocket radio({.farm = farm, .robot = 7, .others = ids});
//   radio.send(bytes);                                             // what encode() made, stamped
//   radio.receive([&](std::span<const std::uint8_t> bytes) { ... radio.accept(bytes, now, packet); });
//
// One thread. No clock is read.

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "netio/address_token.h"
#include "netio/client_registry.h"
#include "netio/endpoint.h"
#include "netio/outbox.h"
#include "netio/packet_status.h"
#include "netio/packets.h"
#include "netio/socket.h"

namespace sf::netio {

struct V2vSocketOptions {
  Endpoint farm;                      ///< that it speaks to, and whose word alone counts
  std::uint32_t robot = 0;            ///< its own id
  std::vector<std::uint32_t> others;  ///< ids of the other robots that the world has
  std::uint32_t session = random_session();
  std::size_t receive_buffer = 1u << 20;
};

class V2vSocket {
 public:
  /// @throws base::InputError when no socket can be opened.
  explicit V2vSocket(const V2vSocketOptions& options);

  /// To the farm, at once, with the newest token.
  void send(std::span<const std::uint8_t> bytes);

  /// Gives `take` each V2V of a NEIGHBOURS, and any other datagram as it is.
  template <class Take>
  static void for_each_state(std::span<const std::uint8_t> bytes, Take&& take) {
    Packet packet;
    if (decode(bytes, packet) != PacketStatus::accepted || packet.header.type != Type::neighbours) return take(bytes);
    const std::span<const std::uint8_t> states = std::get<Neighbours>(packet.body).states;
    for (std::size_t at = 0; at < states.size(); at += kV2vBytes) take(states.subspan(at, kV2vBytes));
  }

  /// Gives `take(std::span<const std::uint8_t> bytes)` all that waits and comes from the farm, as far as it is no
  /// flood, by `for_each_state`. The rest is counted as PacketStatus::wrong_source.
  template <class Take>
  void receive(Take&& take) {
    constexpr std::size_t kMost = 65'536;
    for (std::size_t taken = 0, n = 1; n > 0 && taken < kMost; taken += n) {
      n = batch_.fill(socket_);
      for (std::size_t i = 0; i < n; ++i) {
        if (batch_.source(i) == options_.farm)
          for_each_state(batch_.bytes(i), take);
        else
          counts_.add(PacketStatus::wrong_source);
      }
    }
  }

  /// Any bytes that come from the farm at `now` [ns]: V2V of others, START and CHALLENGE for this robot are accepted
  /// and fill `packet`. What does not carry this robot's session is of the wrong source, as is another session of the
  /// farm than the one that challenged last. What is meant for others is PacketStatus::unknown_robot; old states are
  /// stale.
  PacketStatus accept(std::span<const std::uint8_t> bytes, std::int64_t now, Packet& packet);

  /// A state of `robot` was accepted less than two seconds before `now`.
  bool is_active(std::uint32_t robot, std::int64_t now) const { return others_.is_active(robot, now); }

  /// The stamp of all packets from the farm. Its session is 0 before the first CHALLENGE.
  SessionToken farm_session_token() const { return {farm_session_, options_.session}; }

  const PacketCounts& counts() const { return counts_; }
  OutboxCounts sent() const { return outbox_.counts(); }
  const Socket& socket() const { return socket_; }

 private:
  PacketStatus check(const Packet& packet, std::int64_t now);

  V2vSocketOptions options_;
  Socket socket_;
  Outbox outbox_;
  ClientRegistry others_;
  std::uint32_t farm_session_ = 0;
  std::uint32_t token_ = 0;
  PacketCounts counts_;
  ReceiveBatch batch_;
};

}  // namespace sf::netio
