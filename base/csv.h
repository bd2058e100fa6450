#pragma once
// Fields of comma-separated tables (RFC 4180).

#include <string>

namespace sf::base {

/// Returns `text` as a field, in quotes if it contains a comma, a quote or a line end.
inline std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace sf::base
