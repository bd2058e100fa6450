#pragma once
// What a user tells a controller: words with values, from a scenario file or the command line, judged by the controller
// that reads them.

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "control/raw_text.h"

namespace sf::control {

/// As a file says it, which knows its types; or raw, and then of whatever type it is read as.
using Value = std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>, RawText>;

struct Setting {
  std::string key;
  Value value;
  std::string where;  ///< "file:line: " or "--set kp: ", before every complaint
};

/// Settings by name. Reading marks them as known; what nobody read is an error at the end.
class Settings {
 public:
  Settings() = default;
  /// @param owner "controller 'lane-keeping'": for messages
  Settings(std::string owner, std::vector<Setting> settings);

  // Each gives the fallback where there is no such key.
  // @throws base::InputError when it is of another type or outside [least, most].
  double number(std::string_view key, double fallback, double least, double most);
  bool flag(std::string_view key, bool fallback);
  std::string text(std::string_view key, const std::string& fallback);
  /// One of `words`.
  std::string choice(std::string_view key, const std::string& fallback, const std::vector<std::string>& words);
  std::vector<double> numbers(std::string_view key, const std::vector<double>& fallback);
  std::vector<std::string> texts(std::string_view key, const std::vector<std::string>& fallback);
  bool has(std::string_view key) const;

  /// @throws base::InputError naming the first setting that nobody read, and those that would be.
  void require_all_read() const;
  /// @throws base::InputError, always, at the setting `key`.
  [[noreturn]] void refuse(std::string_view key, const std::string& message) const;

 private:
  const Setting* find(std::string_view key);

  std::string owner_;
  std::vector<Setting> settings_;
  std::vector<bool> read_;
  std::vector<std::string> asked_;  ///< keys, for suggestions
};

}  // namespace sf::control
