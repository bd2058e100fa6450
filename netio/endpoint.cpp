#include "netio/endpoint.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "base/error.h"

namespace sf::netio {

std::uint32_t resolve(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int failure = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (failure != 0) {
    throw base::InputError("no IPv4 address for '" + host + "' (" + gai_strerror(failure) +
                           "): give a dotted address such as 127.0.0.1, or a host name that this machine can resolve");
  }
  const std::uint32_t address = ntohl(reinterpret_cast<const sockaddr_in*>(found->ai_addr)->sin_addr.s_addr);
  freeaddrinfo(found);
  return address;
}

std::optional<std::uint32_t> parse_address(const std::string& text) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1) return std::nullopt;
  return ntohl(address.s_addr);
}

std::vector<std::uint32_t> own_addresses() {
  std::vector<std::uint32_t> addresses;
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return addresses;
  for (const ifaddrs* each = all; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET || (each->ifa_flags & IFF_UP) == 0) continue;
    const std::uint32_t address = ntohl(reinterpret_cast<const sockaddr_in*>(each->ifa_addr)->sin_addr.s_addr);
    if (!is_loopback(address)) addresses.push_back(address);
  }
  freeifaddrs(all);
  return addresses;
}

std::string ipv4_text(std::uint32_t address) {
  std::string line;
  for (int shift = 24; shift >= 0; shift -= 8)
    line += std::to_string(address >> shift & 0xFFu) + (shift > 0 ? "." : "");
  return line;
}

std::string endpoint_text(const Endpoint& endpoint) {
  return ipv4_text(endpoint.address) + ":" + std::to_string(endpoint.port);
}

}  // namespace sf::netio
