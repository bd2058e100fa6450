#pragma once
// Where a socket is bound that speaks with one other end.

#include <cstdint>

#include "netio/endpoint.h"

namespace sf::netio {

/// Loopback where `other` is on it, so that nothing else can reach the socket; else all interfaces.
/// @param port 0: any free one
inline Endpoint own_end_for(std::uint32_t other, std::uint16_t port = 0) {
  return {is_loopback(other) ? kLoopback : 0, port};
}

}  // namespace sf::netio
