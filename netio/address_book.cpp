#include "netio/address_book.h"

#include <charconv>

namespace sf::netio {

std::optional<Endpoint> AddressBook::find(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return std::nullopt;
  std::uint16_t port = 0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data() + colon + 1, last, port);
  if (error != std::errc() || end != last || port == 0) return std::nullopt;
  const auto [host, is_new] = hosts_.try_emplace(text.substr(0, colon));
  if (is_new) host->second = look_up_(host->first);
  return Endpoint{host->second, port};
}

}  // namespace sf::netio
