#pragma once
// Resolves addresses from files and command lines, with one look-up per host.

#include <map>
#include <optional>
#include <string>

#include "netio/endpoint.h"

namespace sf::netio {

/// Not thread-safe: call it from one thread at a time.
class AddressBook {
 public:
  /// @param look_up `resolve`, or a substitute in tests
  explicit AddressBook(std::uint32_t (*look_up)(const std::string& host) = resolve) : look_up_(look_up) {}

  /// Parses "HOST:PORT", with the port in [1, 65535]. @return nullopt for any other form
  /// @throws base::InputError for an unknown host
  std::optional<Endpoint> find(const std::string& text);

 private:
  std::uint32_t (*look_up_)(const std::string& host);
  std::map<std::string, std::uint32_t> hosts_;
};

}  // namespace sf::netio
