#pragma once
// Conversions between netio and POSIX types. Include it in .cpp files only.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "netio/endpoint.h"
#include "netio/socket.h"

namespace sf::netio {

inline sockaddr_in to_posix(const Endpoint& endpoint) {
  sockaddr_in posix{};
  posix.sin_family = AF_INET;
  posix.sin_addr.s_addr = htonl(endpoint.address);
  posix.sin_port = htons(endpoint.port);
  return posix;
}

inline Endpoint from_posix(const sockaddr_in& posix) { return {ntohl(posix.sin_addr.s_addr), ntohs(posix.sin_port)}; }

/// Binds `socket`. @param protocol "UDP" or "TCP", for errors
/// @throws PortInUse
/// @throws base::InputError if the address does not belong to this machine
void bind_socket(const Socket& socket, const Endpoint& endpoint, const char* protocol);

inline std::string error_text(int error) { return std::generic_category().message(error); }

}  // namespace sf::netio
