#include "bridges/web_access.h"

#include <algorithm>
#include <charconv>

#include "base/hash.h"
#include "netio/address_token.h"

namespace sf::bridges {

namespace {

template <class T>
std::optional<T> whole_number(std::string_view text, T largest) {
  unsigned long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || value > largest) return std::nullopt;
  return static_cast<T>(value);
}

bool is_ipv4(std::string_view text) {
  for (int part = 0; part < 4; ++part) {
    const std::size_t dot = part < 3 ? text.find('.') : text.size();
    if (dot == std::string_view::npos || !whole_number<std::uint8_t>(text.substr(0, dot), 255)) return false;
    text.remove_prefix(std::min(text.size(), dot + 1));
  }
  return true;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

}  // namespace

std::optional<WebAddress> read_web_address(std::string_view text) {
  WebAddress address;
  const std::size_t colon = text.rfind(':');
  const std::string_view end = colon == std::string_view::npos ? text : text.substr(colon + 1);
  std::string_view host = colon == std::string_view::npos ? std::string_view() : text.substr(0, colon);
  if (const auto port = whole_number<std::uint16_t>(end, 65535)) {
    address.port = *port;
    if (colon == std::string_view::npos) return address;
  } else if (colon != std::string_view::npos) {
    return std::nullopt;
  } else {
    host = text;
  }
  if (host == "localhost") return address;
  if (!is_ipv4(host)) return std::nullopt;
  address.host = host;
  return address;
}

bool is_loopback(std::string_view host) {
  const std::string name = lower(host);
  return name == "localhost" || name == "::1" || name == "[::1]" || (is_ipv4(name) && name.starts_with("127."));
}

std::string_view host_of(std::string_view authority) {
  const std::size_t end =
      authority.starts_with('[') ? std::min(authority.size(), authority.find(']') + 1) : authority.find(':');
  const std::string_view rest = authority.substr(std::min(end, authority.size()));
  const bool is_port = rest.empty() || rest == ":" ||
                       (rest.front() == ':' && whole_number<std::uint16_t>(rest.substr(1), 65535).has_value());
  return is_port ? authority.substr(0, end) : std::string_view();
}

bool is_own_name(std::string_view host) { return is_loopback(host_of(host)); }

bool is_known_origin(std::string_view origin, std::string_view host) {
  if (origin.empty() || origin == "file://" || origin == "https://app.foxglove.dev") return true;
  const std::size_t scheme = origin.find("://");
  if (scheme == std::string_view::npos) return false;  // "null": a page that hides its origin
  const std::string_view authority = origin.substr(scheme + 3);
  return lower(authority) == lower(host) || is_own_name(authority);
}

std::string_view query_value(std::string_view target, std::string_view key) {
  const std::size_t begin = target.find('?');
  if (begin == std::string_view::npos) return {};
  std::string_view query = target.substr(begin + 1);
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    if (pair.size() > key.size() && pair.starts_with(key) && pair[key.size()] == '=')
      return pair.substr(key.size() + 1);
    query.remove_prefix(std::min(query.size(), pair.size() + 1));
  }
  return {};
}

std::string random_token() {
  const netio::SipHashKey key = netio::random_key();
  return base::hash_hex(key[0]) + base::hash_hex(key[1]);
}

bool same_token(std::string_view given, std::string_view token) {
  unsigned difference = given.size() == token.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(given.size(), token.size()); ++i)
    difference |= static_cast<unsigned>(given[i] ^ token[i]);
  return difference == 0 && !token.empty();
}

}  // namespace sf::bridges
