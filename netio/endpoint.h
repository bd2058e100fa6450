#pragma once
// Where a datagram comes from or goes to. IPv4 only: the testbed's robots, loopback and every container have it.

#include <cstdint>
#include <string>
#include <vector>

namespace sf::netio {

inline constexpr std::uint32_t kLoopback = 0x7F000001u;  ///< 127.0.0.1

/// An IPv4 address and a UDP port, both in host byte order.
struct Endpoint {
  std::uint32_t address = kLoopback;
  std::uint16_t port = 0;  ///< 0: any free port when binding; never a destination
  bool operator==(const Endpoint&) const = default;
};

/// The IPv4 address of a dotted quad or of a host name (asks the machine's resolver; nothing leaves it for dotted
/// quads).
/// @throws base::InputError naming `host` when there is none.
std::uint32_t resolve(const std::string& host);

/// 127.0.0.0/8: nobody else reaches it.
inline bool is_loopback(std::uint32_t address) { return address >> 24 == 127; }
/// Of this machine's interfaces that are up, loopback aside.
std::vector<std::uint32_t> own_addresses();

/// "127.0.0.1".
std::string text_of(std::uint32_t address);
/// "127.0.0.1:10008".
std::string text(const Endpoint& endpoint);

}  // namespace sf::netio
