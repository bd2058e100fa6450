#include "apps/options/peers_option.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/reports/text.h"
#include "base/error.h"
#include "server/peer_file.h"

namespace sf::apps {

std::vector<netio::Peer> peers_of(const PeersOption& options, const world::World* world) {
  if (options.peers.empty()) return {};
  std::vector<netio::Peer> peers = server::read_peers(options.peers, world);
  const bool keys =
      std::any_of(peers.begin(), peers.end(), [](const netio::Peer& peer) { return peer.key.has_value(); });
  if (keys && server::is_open_to_others(options.peers))
    print_message("warning: {} contains keys, and other users can read or change it; run `chmod 600 {}`", options.peers,
                  options.peers);
  return peers;
}

std::string why_unsigned(const PeersOption& options, std::span<const netio::Peer> peers,
                         const std::vector<NamedPeer>& senders) {
  if (std::none_of(peers.begin(), peers.end(), [](const netio::Peer& peer) { return peer.key.has_value(); }))
    return "packets are not signed (sign them with --peers)";
  std::vector<std::string> without;
  for (const NamedPeer& sender : senders) {
    const netio::Peer* const peer = sender.claim ? netio::find(peers, sender.claim->kind, sender.claim->id) : nullptr;
    if (peer == nullptr || !peer->key) without.push_back(sender.name);
  }
  if (without.empty()) return "";
  constexpr std::size_t kMost = 4;
  const std::size_t more = without.size() - std::min(without.size(), kMost);
  without.resize(without.size() - more);
  return fmt::format("{} has no key for {}{}", options.peers, fmt::join(without, ", "),
                     more > 0 ? " and " + counted(more, "other") : "");
}

void require_signable(const std::vector<netio::Peer>& peers, sensors::WireFormat wire) {
  if (wire != sensors::WireFormat::thesis) return;
  for (const netio::Peer& peer : peers)
    if (peer.kind == netio::PeerKind::robot && peer.key)
      throw base::InputError(
          "readings of --wire thesis cannot be signed, but --peers has the key of a robot: leave out one of the two");
}

}  // namespace sf::apps
