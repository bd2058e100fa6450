#include "apps/exposure_warning.h"

#include <cstdio>

#include "netio/endpoint.h"

namespace sf::apps {

void warn_of_exposure(std::uint32_t address, const std::string& can) {
  if (netio::is_loopback(address)) return;
  const std::string bound = netio::text_of(address);
  std::string reached = "whoever reaches " + bound;
  if (address == 0) {
    std::string own;
    for (const std::uint32_t each : netio::own_addresses()) own += (own.empty() ? "" : " or ") + netio::text_of(each);
    reached = own.empty() ? "every interface, of which this machine has none but loopback" : "whoever reaches " + own;
  }
  std::fprintf(stderr,
               "sensorfarm: warning: --bind %s opens it to %s: anyone there can %s, since packets are not signed; "
               "--bind 127.0.0.1 keeps it to this machine\n",
               bound.c_str(), reached.c_str(), can.c_str());
}

}  // namespace sf::apps
