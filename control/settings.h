#pragma once
// Settings of a controller: keys with values from a scenario file or the command line, validated by the controller that
// reads them.

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "control/raw_text.h"

namespace sf::control {

/// A typed value from a file, or untyped text from the command line.
using Value = std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>, RawText>;

struct Setting {
  std::string key;
  Value value;
  std::string where;  ///< "file:line: " or "--set kp: ", prefix of error messages
};

/// Settings by key. Reading a setting marks it as known; unread settings are errors.
class Settings {
 public:
  Settings() = default;
  /// @param owner for messages, such as "controller 'lane-keeping'"
  Settings(std::string owner, std::vector<Setting> settings);

  // Each function returns the fallback if the key is absent.
  // @throws base::InputError for a value of another type or outside [least, most]
  double number(std::string_view key, double fallback, double least, double most);
  bool flag(std::string_view key, bool fallback);
  std::string text(std::string_view key, const std::string& fallback);
  /// Returns one of `words`.
  std::string choice(std::string_view key, const std::string& fallback, const std::vector<std::string>& words);
  std::vector<double> numbers(std::string_view key, const std::vector<double>& fallback);
  std::vector<std::string> texts(std::string_view key, const std::vector<std::string>& fallback);
  bool has(std::string_view key) const;

  /// @throws base::InputError naming the first unread setting, and the keys that were requested
  void require_all_read() const;
  /// @throws base::InputError always, with the location of the setting `key`
  [[noreturn]] void refuse(std::string_view key, const std::string& message) const;

 private:
  const Setting* find(std::string_view key);

  std::string owner_;
  std::vector<Setting> settings_;
  std::vector<bool> read_;
  std::vector<std::string> asked_;  ///< requested keys, for suggestions
};

}  // namespace sf::control
