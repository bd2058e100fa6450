#pragma once
// Source or destination of datagrams. IPv4 only: the testbed's robots, loopback and containers all support it.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sf::netio {

inline constexpr std::uint32_t kLoopback = 0x7F000001u;  ///< 127.0.0.1

/// An IPv4 address and a UDP port, both in host byte order.
struct Endpoint {
  std::uint32_t address = kLoopback;
  std::uint16_t port = 0;  ///< 0: any free port when binding; invalid as a destination
  bool operator==(const Endpoint&) const = default;
};

/// Returns the IPv4 address of a dotted quad or a host name. The machine's resolver looks up host names; dotted quads
/// need no network.
/// @throws base::InputError naming `host` if it has no address
std::uint32_t resolve(const std::string& host);

/// Returns the IPv4 address of a dotted quad; nullopt for anything else.
std::optional<std::uint32_t> parse_address(const std::string& text);

/// Returns whether the address is in 127.0.0.0/8, which is reachable only from this machine.
inline bool is_loopback(std::uint32_t address) { return address >> 24 == 127; }
/// Returns the addresses of this machine's interfaces that are up, except loopback.
std::vector<std::uint32_t> own_addresses();

/// "127.0.0.1".
std::string ipv4_text(std::uint32_t address);
/// Returns "127.0.0.1:10008".
std::string endpoint_text(const Endpoint& endpoint);

}  // namespace sf::netio
