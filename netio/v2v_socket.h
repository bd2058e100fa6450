#pragma once
// The robot's side of V2V: one socket that sends to the farm and receives the states of other robots.
//
//   V2vSocket radio({.farm = farm, .robot = 7, .others = ids});
//   radio.send(bytes);                                             // an encoded packet
//   radio.receive([&](std::span<const std::uint8_t> bytes) { ... radio.accept(bytes, now, packet); });
//
// Single-threaded. Reads no clock.

#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "netio/address_token.h"
#include "netio/endpoint.h"
#include "netio/outbox.h"
#include "netio/packet_status.h"
#include "netio/packets.h"
#include "netio/sender_bindings.h"
#include "netio/signature.h"
#include "netio/socket.h"

namespace sf::netio {

struct V2vSocketOptions {
  Endpoint farm;                      ///< destination, and the only accepted source
  std::uint32_t robot = 0;            ///< id of this robot
  std::vector<std::uint32_t> others;  ///< ids of the world's other robots
  std::uint32_t session = random_session();
  std::size_t receive_buffer = 1u << 20;
  std::optional<SigningKey> key;      ///< signs sent packets, and must have signed received packets
  std::vector<std::uint32_t> lights;  ///< ids of the world's intersections
};

/// The reason why robot and farm exchange no signed packets.
struct SignatureTrouble {
  PacketStatus reason = PacketStatus::accepted;  ///< not_signed, wrong_signature or replayed; for the farm also
                                                 ///< wrong_source; accepted: no trouble
  bool of_farm = false;  ///< the farm refuses the robot's packets (as a REFUSAL states, which is not signed); false:
                         ///< the robot refuses the farm's
  std::int64_t farm_time = 0;  ///< [ns] Unix time of the REFUSAL; 0: none
  std::uint64_t count = 0;     ///< number of packets refused so far, or of REFUSALs
};

class V2vSocket {
 public:
  /// @throws base::InputError if no socket can be opened
  explicit V2vSocket(const V2vSocketOptions& options);

  /// Sends a packet to the farm immediately, with the newest token, and signed if there is a key.
  void send(std::span<const std::uint8_t> bytes);

  /// Passes each V2V of a NEIGHBOURS packet to `take`, and any other datagram unchanged.
  template <class Take>
  static void for_each_state(std::span<const std::uint8_t> bytes, Take&& take) {
    Packet packet;
    if (decode(bytes, packet) != PacketStatus::accepted || packet.header.type != Type::neighbours) return take(bytes);
    const std::span<const std::uint8_t> states = std::get<Neighbours>(packet.body).states;
    for (std::size_t at = 0; at < states.size(); at += kV2vBytes) take(states.subspan(at, kV2vBytes));
  }

  /// Passes all waiting datagrams from the farm, up to a limit, through `for_each_state` to `take(std::span<const
  /// std::uint8_t> bytes)`. Counts others as PacketStatus::wrong_source, or by the fault of their signature.
  template <class Take>
  void receive(Take&& take) {
    constexpr std::size_t kMost = 65'536;
    batch_.drain(socket_, kMost, [&](std::span<const std::uint8_t> bytes, const Endpoint& source) {
      if (source == options_.farm && take_refusal(bytes)) return;
      const PacketStatus status = source == options_.farm ? check_signature(bytes) : PacketStatus::wrong_source;
      if (status != PacketStatus::wrong_source) note_trouble(status);
      if (status == PacketStatus::accepted)
        for_each_state(bytes, take);
      else
        counts_.add(status);
    });
  }

  /// Checks any bytes from the farm, received at `now` [ns]. Accepts V2V of other robots, V2I, and START, CHALLENGE,
  /// DRIVE, LANE and DROPPED for this robot, and fills `packet`. Packets without this robot's session, or with a
  /// session of the farm other than that of the last challenge, are wrong_source. Packets for other robots are
  /// unknown_robot, V2I of other intersections are unknown_light, and old states are stale.
  PacketStatus accept(std::span<const std::uint8_t> bytes, std::int64_t now, Packet& packet);

  /// Returns whether a state of `robot` was accepted less than two seconds before `now`.
  bool is_active(std::uint32_t robot, std::int64_t now) const { return others_.is_active(robot, now); }

  /// Returns session and token of all packets from the farm. The session is 0 before the first CHALLENGE.
  SessionToken farm_session_token() const { return {farm_session_, options_.session}; }

  const PacketCounts& counts() const { return counts_; }
  /// Returns the last trouble.
  const SignatureTrouble& trouble() const { return trouble_; }
  OutboxCounts sent() const { return outbox_.counts(); }
  const Socket& socket() const { return socket_; }

 private:
  PacketStatus check(const Packet& packet, std::int64_t now);
  PacketStatus check_signature(std::span<const std::uint8_t> bytes);
  bool take_refusal(std::span<const std::uint8_t> bytes);
  void note_trouble(PacketStatus status);

  V2vSocketOptions options_;
  Socket socket_;
  Outbox outbox_;
  SenderBindings others_;
  SenderBindings lights_;
  SenderBindings drives_;  ///< DRIVE for this robot, by its id
  SenderBindings lanes_;   ///< LANE for this robot, by its id
  SenderBindings drops_;   ///< DROPPED for this robot, by its id
  std::uint32_t farm_session_ = 0;
  std::uint32_t token_ = 0;
  PacketCounts counts_;
  SignatureTrouble trouble_;
  ReceiveBatch batch_;
  std::optional<PacketSigner> signer_;
  std::optional<SignatureChecker> checker_;
};

}  // namespace sf::netio
