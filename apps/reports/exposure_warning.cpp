#include "apps/reports/exposure_warning.h"

#include "apps/reports/text.h"
#include "netio/endpoint.h"

namespace sf::apps {

void warn_of_exposure(std::uint32_t address, const std::string& can, const std::string& since,
                      const std::string& option) {
  if (netio::is_loopback(address)) return;
  const std::string bound = netio::ipv4_text(address);
  std::string reached = "whoever reaches " + bound;
  if (address == 0) {
    std::string own;
    for (const std::uint32_t each : netio::own_addresses()) own += (own.empty() ? "" : " or ") + netio::ipv4_text(each);
    reached = own.empty() ? "every interface (this machine has only loopback)" : "whoever reaches " + own;
  }
  print_message(
      "warning: {0} {1} opens the port to {2}: anyone there can {3}, since {4}; use {0} 127.0.0.1 to allow this "
      "machine only",
      option, bound, reached, can, since);
}

}  // namespace sf::apps
