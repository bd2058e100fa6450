#pragma once
// `--peers`: the table of addresses and keys.

#include <vector>

#include "apps/options.h"
#include "netio/peers.h"
#include "world/world.h"

namespace sf::apps {

/// The table, empty without the option. Warns of a file of keys that others may read.
/// @param world whose ids the table may have; null: any
std::vector<netio::Peer> peers_of(const PeersOption& options, const world::World* world);

/// Readings of `--wire thesis` have no place for a signature. @throws base::InputError for this layout and a robot's
/// key
void require_signable(const std::vector<netio::Peer>& peers, sensors::WireFormat wire);

}  // namespace sf::apps
