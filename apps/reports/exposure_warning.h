#pragma once
// The hosts that can send to a socket bound beyond this machine.

#include <cstdint>
#include <string>

namespace sf::apps {

/// On standard error, where `address` is not loopback.
/// @param can the risk: "say where robots are"  @param option that opens it
/// @param since why they can
void warn_of_exposure(std::uint32_t address, const std::string& can,
                      const std::string& since = "packets are not signed", const std::string& option = "--bind");

}  // namespace sf::apps
