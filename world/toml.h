#pragma once
// TOML as plain values with their lines: for sidecars of road networks and for scenario files. toml++ is in the source.

#include <string>
#include <string_view>
#include <vector>

namespace sf::world {

/// One value of a TOML file.
struct TomlNode {
  enum class Kind { flag, number, text, list, table, other };  ///< other: dates and times
  Kind kind = Kind::table;
  std::string key;              ///< where it stands in a table
  int line = 0;                 ///< 1-based, of its key, or of itself where it has none
  bool flag = false;            ///< value of a flag
  double number = 0.0;          ///< value of a number, whole or not; may be infinite or not a number
  std::string text;             ///< value of a text
  std::vector<TomlNode> items;  ///< of a list in order, of a table by key
};

/// Null where the table has no such key. Lives as long as the table.
const TomlNode* find(const TomlNode& table, std::string_view key);

/// The table that the text is.
/// @param file its name, for messages
/// @throws base::InputError with file and line where it is no TOML, has characters beyond ASCII outside comments of
/// their own line, nests deeper than 32 levels (a key of many parts does, too), or is larger than 4 MiB.
TomlNode parse_toml(const std::string& file, std::string_view text);

}  // namespace sf::world
