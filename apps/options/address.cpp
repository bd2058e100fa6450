#include "apps/options/address.h"

#include <fmt/format.h>

#include <charconv>

#include "base/error.h"

namespace sf::apps {

netio::Endpoint read_address(netio::AddressBook& book, const std::string& text, const std::string& option,
                             const std::string& file) {
  if (const auto endpoint = book.find(text)) return *endpoint;
  const std::string message = fmt::format("'{}' is not an address; expected HOST:PORT such as 192.168.1.5:9000", text);
  throw file.empty() ? base::InputError(option + ": " + message) : base::InputError(file, 0, message);
}

netio::Endpoint read_own_address(const std::string& text, const std::string& option) {
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  netio::Endpoint endpoint;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), endpoint.port);
  if (error != std::errc() || end != port.data() + port.size() || colon == 0)
    throw base::InputError(
        fmt::format("{}: '{}' is not an address; expected a port or HOST:PORT; to use the default, write the option "
                    "last, or give {}=PORT",
                    option, text, option));
  if (colon != std::string::npos) endpoint.address = netio::resolve(text.substr(0, colon));
  return endpoint;
}

}  // namespace sf::apps
