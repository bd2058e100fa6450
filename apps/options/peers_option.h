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

/// The table, empty without the option. Warns of a file of keys that others may read.
/// @param world whose ids the table may have; null: any
std::vector<netio::Peer> peers_of(const PeersOption& options, const world::World* world);

/// One that may send, by the name that users have for it.
struct NamedPeer {
  std::optional<netio::Claim> claim;  ///< nullopt: its packets are unsigned
  std::string name;
};
/// Why strangers can speak for some of `senders`; empty: all have a key.
std::string why_unsigned(const PeersOption& options, std::span<const netio::Peer> peers,
                         const std::vector<NamedPeer>& senders);

/// Readings of `--wire thesis` have no place for a signature. @throws base::InputError for this layout and a robot's
/// key
void require_signable(const std::vector<netio::Peer>& peers, sensors::WireFormat wire);

}  // namespace sf::apps
