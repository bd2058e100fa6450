#pragma once
// Who may talk to a server on this machine. A page of any web site can make its reader's browser connect to it: such
// connections name that site (Origin), or reach it by a foreign name that was pointed here (DNS rebinding).

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sf::bridges {

struct WebAddress {
  std::string host = "127.0.0.1";  ///< IPv4 address; "localhost" is read as 127.0.0.1
  std::uint16_t port = 8765;       ///< 0: any free one
};

/// "[HOST:]PORT" or "HOST", HOST an IPv4 address or "localhost". @return nullopt for other texts
std::optional<WebAddress> read_web_address(std::string_view text);

/// Of an address such as "127.0.0.1" or a name such as "localhost"; false for all other names.
bool is_loopback(std::string_view host);

/// The name in "name:port", "[::1]:port" or "name".
std::string_view host_of(std::string_view authority);

/// Whether a request came under a name of this machine: true for loopback names. @param host header of the request
bool is_own_name(std::string_view host);

/// Whether scripts of that origin may connect: none is named (no browser), the page came from `host` itself or from
/// this machine (http://localhost, file://), or from Foxglove's own viewer (https://app.foxglove.dev).
/// @param origin header of the request; empty: there is none
bool is_known_origin(std::string_view origin, std::string_view host);

/// The value of `key` in the query of a request's target; empty where there is none. Nothing is unescaped.
std::string_view query_value(std::string_view target, std::string_view key);

/// 32 hexadecimal digits from the kernel's random number generator.
std::string random_token();
/// In a time that does not depend on where both differ.
bool same_token(std::string_view given, std::string_view token);

}  // namespace sf::bridges
