#include "apps/exposure_warning.h"

#include "apps/text.h"
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
  print_message(
      "warning: --bind {} opens it to {}: anyone there can {}, since packets are not signed; "
      "--bind 127.0.0.1 keeps it to this machine",
      bound, reached, can);
}

}  // namespace sf::apps
