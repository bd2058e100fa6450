#pragma once
// Senders that the farm knows in advance: the address that a robot's or tag's packets must come from, and the key that
// must sign them.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "netio/endpoint.h"
#include "netio/packets.h"
#include "netio/signature.h"

namespace sf::netio {

enum class PeerKind : std::uint8_t { robot, tag, start, light, group, centre };

struct Peer {
  PeerKind kind = PeerKind::robot;  ///< start: the sender of START and LANE; light: the sender of V2I and SPaT; group:
                                    ///< all robots that send V2V to each other; centre: the control centre, which
                                    ///< receives the V2V states of all robots
  std::uint32_t id = 0;             ///< id of the robot, tag or intersection; 0 for start, group and centre
  std::optional<std::uint32_t> address;  ///< IPv4, host byte order; nullopt: any
  std::optional<SigningKey> key;         ///< nullopt: packets need no signature
};

/// Returns the peer; null if `peers` does not contain it.
const Peer* find(std::span<const Peer> peers, PeerKind kind, std::uint32_t id);

/// The peer that a packet to the farm claims to be from.
struct Claim {
  PeerKind kind = PeerKind::robot;
  std::uint32_t id = 0;
};
Claim claim_of(const Header& header);

/// The farm's state of each peer: counters received from it, and the next counter sent to it. Single-threaded.
class PeerTable {
 public:
  /// @param peers each kind and id at most once
  /// @param first_counter of packets to robots
  explicit PeerTable(std::span<const Peer> peers, std::uint64_t first_counter = unix_microseconds());

  bool has_key(const Claim& claim);
  /// Checks a decoded packet that was received from `source`. Accepts peers that are not in the table.
  /// @param proven false: the packet's counter is neither checked nor recorded
  /// @return accepted, wrong_source, not_signed, wrong_signature or replayed
  PacketStatus check(const Claim& claim, std::span<const std::uint8_t> bytes, const Endpoint& source, bool proven);

  /// Returns `SignatureChecker::lag` of the peer's last checked packet; 0 without a key.
  std::uint64_t lag(const Claim& claim);

  /// Returns the signer of packets to a peer; null without a key. Valid as long as the table.
  PacketSigner* signer(const Claim& claim);

 private:
  struct Row {
    Peer peer;
    std::optional<SignatureChecker> checker;
    std::optional<PacketSigner> signer;
  };
  Row* find_row(const Claim& claim);

  std::vector<Row> rows_;  ///< sorted by kind and id
};

}  // namespace sf::netio
