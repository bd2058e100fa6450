#pragma once
// Addresses as files and command lines have them, with one look-up for each host.

#include <map>
#include <optional>
#include <string>

#include "netio/endpoint.h"

namespace sf::netio {

/// One thread at a time.
class AddressBook {
 public:
  /// @param look_up `resolve`, or another in tests
  explicit AddressBook(std::uint32_t (*look_up)(const std::string& host) = resolve) : look_up_(look_up) {}

  /// @param text "HOST:PORT", the port from 1 to 65535. @return nothing for another form
  /// @throws base::InputError for an unknown host
  std::optional<Endpoint> find(const std::string& text);

 private:
  std::uint32_t (*look_up_)(const std::string& host);
  std::map<std::string, std::uint32_t> hosts_;
};

}  // namespace sf::netio
