#pragma once
// Warns if hosts other than this machine can send to a socket.

#include <cstdint>
#include <string>

namespace sf::apps {

/// Prints a warning on standard error unless `address` is a loopback address.
/// @param can the risk: "say where robots are" @param option that opens the socket
/// @param since the reason why they can
void warn_of_exposure(std::uint32_t address, const std::string& can,
                      const std::string& since = "packets are not signed", const std::string& option = "--bind");

}  // namespace sf::apps
