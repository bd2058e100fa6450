#include "apps/address.h"

#include <fmt/format.h>

#include "base/error.h"

namespace sf::apps {

netio::Endpoint read_address(netio::AddressBook& book, const std::string& text, const std::string& option,
                             const std::string& file) {
  if (const auto endpoint = book.find(text)) return *endpoint;
  const std::string message = fmt::format("'{}' is no address; expected HOST:PORT such as 192.168.1.5:9000", text);
  throw file.empty() ? base::InputError(option + ": " + message) : base::InputError(file, 0, message);
}

}  // namespace sf::apps
