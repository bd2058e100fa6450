#pragma once
// The hosts that can send to a socket bound beyond this machine.

#include <cstdint>
#include <string>

namespace sf::apps {

/// On standard error, where `address` is not loopback. @param can the risk: "say where robots are"
void warn_of_exposure(std::uint32_t address, const std::string& can);

}  // namespace sf::apps
