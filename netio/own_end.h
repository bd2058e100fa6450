#pragma once
// Chooses the local address of a socket that communicates with a single peer.

#include <cstdint>

#include "netio/endpoint.h"

namespace sf::netio {

/// Returns loopback if `other` is a loopback address, so that no other machine can reach the socket; otherwise all
/// interfaces.
/// @param port 0: any free port
inline Endpoint own_end_for(std::uint32_t other, std::uint16_t port = 0) {
  return {is_loopback(other) ? kLoopback : 0, port};
}

}  // namespace sf::netio
