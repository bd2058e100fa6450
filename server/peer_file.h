#pragma once
// Files for `--peers`: addresses and keys of robots, tags and the sender of START. See docs/robots.md for an example.

#include <string>
#include <string_view>
#include <vector>

#include "netio/peers.h"
#include "world/world.h"

namespace sf::server {

inline constexpr std::size_t kMaxPeers = 16'384;

/// @param file name for error messages, which never contain a key @param world whose robots and tags may be named;
/// null: accepts any id that fits a packet
/// @throws base::InputError with file and line
std::vector<netio::Peer> parse_peers(const std::string& file, std::string_view text, const world::World* world);
/// @throws base::InputError also for a file that cannot be read
std::vector<netio::Peer> read_peers(const std::string& file, const world::World* world);

/// Returns whether users other than the owner may read, write or execute `file`.
bool is_open_to_others(const std::string& file);

}  // namespace sf::server
