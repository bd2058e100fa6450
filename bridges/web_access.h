#pragma once
// Access control of a server on this machine. A page of any web site can make its reader's browser connect to the
// server. Such connections name that site (Origin), or use a foreign host name that resolves to this machine (DNS
// rebinding).

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sf::bridges {

struct WebAddress {
  std::string host = "127.0.0.1";  ///< IPv4 address; "localhost" is read as 127.0.0.1
  std::uint16_t port = 8765;       ///< 0: any free port
};

/// Parses "[HOST:]PORT" or "HOST", where HOST is an IPv4 address or "localhost".
/// @return nullopt for any other text
std::optional<WebAddress> read_web_address(std::string_view text);

/// Returns whether `host` is a loopback address such as "127.0.0.1" or a name such as "localhost".
bool is_loopback(std::string_view host);

/// Returns the name in "name:port", "[::1]:port" or "name".
std::string_view host_of(std::string_view authority);

/// Returns whether a request used a loopback name of this machine.
/// @param host header of the request
bool is_own_name(std::string_view host);

/// Returns whether scripts of that origin may connect: no origin is given (not a browser), the page came from `host`
/// itself or from this machine (http://localhost, file://), or from Foxglove's own viewer (https://app.foxglove.dev).
/// @param origin header of the request; empty: none
bool is_known_origin(std::string_view origin, std::string_view host);

/// Returns the value of `key` in the query of a request's target; empty if missing. Does not unescape.
std::string_view query_value(std::string_view target, std::string_view key);

/// Returns 32 hexadecimal digits from the kernel's random number generator.
std::string random_token();
/// Compares in a time that does not depend on the position of a difference.
bool same_token(std::string_view given, std::string_view token);

}  // namespace sf::bridges
