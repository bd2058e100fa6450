#pragma once
// `--peers`: the table of addresses and keys.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/options/options.h"
#include "netio/peers.h"
#include "world/world.h"

namespace sf::apps {

/// Returns the table; empty without the option. Warns if other users can read a file with keys.
/// @param world whose ids the table may contain; null: any id
std::vector<netio::Peer> peers_of(const PeersOption& options, const world::World* world);

/// A sender with the name that users see.
struct NamedPeer {
  std::optional<netio::Claim> claim;  ///< nullopt: its packets are unsigned
  std::string name;
};
/// Explains why strangers can impersonate some of `senders`; empty: all have a key.
std::string why_unsigned(const PeersOption& options, std::span<const netio::Peer> peers,
                         const std::vector<NamedPeer>& senders);

/// Readings in `--wire thesis` have no field for a signature. @throws base::InputError if this layout is combined with
/// a robot's key
void require_signable(const std::vector<netio::Peer>& peers, sensors::WireFormat wire);

}  // namespace sf::apps
