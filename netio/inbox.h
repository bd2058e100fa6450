#pragma once
// Datagrams in, states out. Nothing a stranger sends stops it, and nothing is allocated after construction.
//
//   Inbox inbox({.robots = ids});
//   inbox.receive(now, [&](const Packet& packet) { ... });        // each accepted one
//   if (inbox.is_active(7, now) && inbox.is_subscribed(7, kind, now)) ...      // send to *inbox.address(7)
//
// A robot is heard from an address that sends back what it was sent there (netio/address_token.h): until then it is
// answered by a CHALLENGE, which is no larger than what it sent.
//
// One thread. No clock is read: `now` is any clock in ns that does not go back.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "netio/address_token.h"
#include "netio/client_registry.h"
#include "netio/endpoint.h"
#include "netio/packet_status.h"
#include "netio/packets.h"
#include "netio/ports.h"
#include "netio/socket.h"

namespace sf::netio {

struct InboxOptions {
  Endpoint bind = {kLoopback, kInboxPort};   ///< address 0 (0.0.0.0): every interface of the machine
  std::size_t receive_buffer = 4u << 20;     ///< [byte] asked of the kernel
  std::vector<std::uint32_t> robots;         ///< ids that the world has, each in [0, kMaxId], no two equal
  std::vector<std::uint32_t> tags;           ///< each in [kMinTag, kMaxId]
  std::uint32_t session = random_session();  ///< the farm's
};

class Inbox {
 public:
  /// Datagrams taken by one receive at most: a flood may not hold the tick.
  static constexpr std::size_t kMaxPerReceive = 65'536;
  /// CHALLENGEs in a tenth of a second at most: the rest are not answered.
  static constexpr std::size_t kMaxChallenges = 1000;

  /// @throws base::InputError when the address cannot be bound, or an id does not fit a packet.
  explicit Inbox(const InboxOptions& options);

  /// Takes every datagram that waits and gives `take(const Packet&)` each accepted one, in order of arrival, and
  /// `on_rejected(PacketStatus, const Packet&, const Endpoint& who)` each that was well but unproven or from the wrong
  /// source. Returns how many were taken from the socket.
  template <class Take, class OnRejected>
  std::size_t receive(std::int64_t now, Take&& take, OnRejected&& on_rejected) {
    std::size_t taken = 0;
    Packet packet;
    while (taken < kMaxPerReceive) {
      const std::size_t n = batch_.fill(socket_);
      if (n == 0) break;
      for (std::size_t i = 0; i < n; ++i) {
        const PacketStatus status = accept(batch_.bytes(i), batch_.source(i), now, packet);
        if (status == PacketStatus::accepted) take(packet);
        if (status == PacketStatus::unproven || status == PacketStatus::wrong_source)
          on_rejected(status, packet, batch_.source(i));
      }
      taken += n;
    }
    return taken;
  }

  template <class Take>
  std::size_t receive(std::int64_t now, Take&& take) {
    return receive(now, take, [](PacketStatus, const Packet&, const Endpoint&) {});
  }

  /// One datagram, from wherever: decides, counts, and fills `packet` when accepted, unproven or from the wrong source
  /// (else it holds nothing of use). receive() is this for a socket.
  PacketStatus accept(std::span<const std::uint8_t> bytes, const Endpoint& source, std::int64_t now, Packet& packet);

  /// The answer to an unproven V2V or SUBSCRIBE that came from `who`. @return false where none is due, or too many
  /// were.
  bool challenge(const Packet& packet, const Endpoint& who, std::int64_t now, base::Bytes& out);

  /// A V2V or SUBSCRIBE of `robot` was accepted less than two seconds before `now`, and no LEAVE since.
  bool is_active(std::uint32_t robot, std::int64_t now) const { return robots_.is_active(robot, now); }

  /// heard, and its last SUBSCRIBE since it is heard asked for sensor kind `kind` in [1, 31] (none: it wants all).
  bool is_subscribed(std::uint32_t robot, std::uint32_t kind, std::int64_t now) const;

  /// heard, and its last SUBSCRIBE since it is heard asked for other robots' states.
  bool wants_neighbours(std::uint32_t robot, std::int64_t now) const;

  /// Where `robot` sends from; nothing when it was never heard, or left. Its readings go to this address, at each
  /// sensor's own port.
  std::optional<Endpoint> address(std::uint32_t robot) const { return robots_.source(robot); }

  /// The token that packets from `who` must carry.
  std::uint32_t token(const Endpoint& who) const { return tokens_.of(who); }
  /// For packets to `robot`: the farm's session, and the one that the robot gave last.
  SessionToken session_token_for(std::uint32_t robot) const;

  /// Where tag `tag` is sent from.
  std::optional<Endpoint> tag_address(std::uint32_t tag) const { return tags_.source(tag); }

  std::uint16_t port() const { return bound_endpoint(socket_).port; }
  const PacketCounts& counts() const { return counts_; }
  std::uint64_t kernel_drops() const { return netio::kernel_drops(socket_); }
  /// The same socket once more: for answers that come from where the robots speak to.
  Socket socket() const { return duplicate(socket_); }
  /// Sleeps until a datagram waits, a signal comes, or `timeout_ms` >= 0 has passed.
  void wait(int timeout_ms) const;

 private:
  PacketStatus check(const Packet& packet, const Endpoint& source, std::int64_t now);
  PacketStatus check_robot(const Packet& packet, const Endpoint& source, std::int64_t now);

  ClientRegistry robots_;
  ClientRegistry tags_;
  std::vector<std::uint32_t> kinds_;     ///< per robot row: mask of its last SUBSCRIBE, 0 for all
  std::vector<std::uint32_t> sessions_;  ///< per robot row: of its last packet
  std::uint32_t session_;
  AddressTokens tokens_;
  std::int64_t challenge_period_start_ = 0;  ///< [ns]
  std::size_t challenges_ = 0;               ///< since then
  PacketCounts counts_;
  Socket socket_;
  ReceiveBatch batch_;
};

}  // namespace sf::netio
