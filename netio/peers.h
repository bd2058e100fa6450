#pragma once
// Senders that the farm knows beforehand: the address that a robot's or tag's packets have to come from, and the key
// that they have to be signed with.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "netio/endpoint.h"
#include "netio/packets.h"
#include "netio/signature.h"

namespace sf::netio {

enum class PeerKind : std::uint8_t { robot, tag, start, light };

struct Peer {
  PeerKind kind = PeerKind::robot;       ///< start: the sender of START; light: the sender of V2I and SPaT
  std::uint32_t id = 0;                  ///< of the robot, tag or intersection; 0 for start
  std::optional<std::uint32_t> address;  ///< IPv4, host byte order; nullopt: any
  std::optional<SigningKey> key;         ///< nullopt: packets need no signature
};

/// Null where `peers` has none.
const Peer* find(std::span<const Peer> peers, PeerKind kind, std::uint32_t id);

/// The peer that a packet to the farm claims to be from.
struct Claim {
  PeerKind kind = PeerKind::robot;
  std::uint32_t id = 0;
};
Claim claim_of(const Header& header);

/// The farm's state of each peer: counters that came from it, and the next one to it. One thread.
class PeerTable {
 public:
  /// @param peers each kind and id once
  /// @param first_counter of packets to robots
  explicit PeerTable(std::span<const Peer> peers, std::uint64_t first_counter = unix_microseconds());

  bool has_key(const Claim& claim);
  /// Checks a decoded packet that came from `source`. Peers that are not in the table are accepted.
  /// @param proven false: the packet's counter neither counts nor is checked
  /// @return accepted, wrong_source, not_signed, wrong_signature or replayed
  PacketStatus check(const Claim& claim, std::span<const std::uint8_t> bytes, const Endpoint& source, bool proven);

  /// See `SignatureChecker::lag`, of the peer's last checked packet; 0 without a key.
  std::uint64_t lag(const Claim& claim);

  /// Signs packets to a peer; null without a key. Lives as long as the table.
  PacketSigner* signer(const Claim& claim);

 private:
  struct Row {
    Peer peer;
    std::optional<SignatureChecker> checker;
    std::optional<PacketSigner> signer;
  };
  Row* find_row(const Claim& claim);

  std::vector<Row> rows_;  ///< by kind and id
};

}  // namespace sf::netio
