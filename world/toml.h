#pragma once
// TOML as plain values with line numbers, for sidecars of road networks and for scenario files. Only the source file
// uses toml++.

#include <string>
#include <string_view>
#include <vector>

namespace sf::world {

/// One value of a TOML file.
struct TomlNode {
  enum class Kind { flag, number, text, list, table, other };  ///< other: dates and times
  Kind kind = Kind::table;
  std::string key;              ///< its key in a table
  int line = 0;                 ///< 1-based, line of the key, or of the value if it has no key
  bool flag = false;            ///< value of a flag
  double number = 0.0;          ///< value of a number, integer or not; may be infinite or NaN
  std::string text;             ///< value of a text
  std::vector<TomlNode> items;  ///< of a list in order, of a table by key
};

/// Returns null if the table has no such key. Valid for the lifetime of the table.
const TomlNode* find(const TomlNode& table, std::string_view key);

/// Parses `text` as one table.
/// @param file name for errors
/// @throws base::InputError with file and line for a text that is not TOML, for non-ASCII characters outside comments
/// on their own line, for more than 32 levels (a key of many parts counts as many levels), and for more than 4 MiB
TomlNode parse_toml(const std::string& file, std::string_view text);

}  // namespace sf::world
