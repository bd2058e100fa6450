#pragma once
// Reads bounded values from a TOML file. Every error has the file, the line, and the expected value.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "world/toml.h"

namespace sf::world {

/// Returns the value as quoted in errors: a number, up to 40 characters of a text in quotes, true, false, or its kind.
std::string shown_toml(const TomlNode& node);

/// Functions with a key return the fallback, or null, if `table` does not have it. @throws base::InputError
class TomlReader {
 public:
  /// @param file for errors; must outlive the reader
  explicit TomlReader(const std::string& file) : file_(file) {}

  const std::string& file() const { return file_; }
  [[noreturn]] void fail(const TomlNode& node, const std::string& message) const;

  /// Rejects a file that belongs to other commands, by its keys.
  /// @param expected "a scenario", "a sweep", "a testbed" or "a plan of traffic lights"
  void require_kind(const TomlNode& root, std::string_view expected) const;
  /// Rejects keys that are not in `known`, with a suggestion.
  void require_known(const TomlNode& table, std::span<const std::string_view> known) const;

  /// @param unit for errors, e.g. "seconds"; empty: a bare number
  double number(const TomlNode& table, std::string_view key, double fallback, double least, double most,
                std::string_view unit = {}) const;
  double number(const TomlNode& node, std::string_view key, double least, double most,
                std::string_view unit = {}) const;
  std::uint64_t whole(const TomlNode& table, std::string_view key, std::uint64_t fallback, double most) const;
  std::string text(const TomlNode& table, std::string_view key, const std::string& fallback) const;
  /// Returns false if `table` does not have the key.
  bool flag(const TomlNode& table, std::string_view key) const;
  const TomlNode* table(const TomlNode& in, std::string_view key) const;
  /// Returns the items of `[[key]]`.
  std::vector<const TomlNode*> tables(const TomlNode& in, std::string_view key) const;
  /// Overwrites `into`, whose size is the number of values; each is within +-`most`.
  /// @param expected for errors, e.g. "[x, y, z] in metres"
  void numbers(const TomlNode& table, std::string_view key, std::span<double> into, double most,
               std::string_view expected) const;

 private:
  const std::string& file_;
};

}  // namespace sf::world
