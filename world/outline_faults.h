#pragma once
// Faults of rows in a file of outlines: warnings with lines, in a bounded number.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "world/outline_rows.h"
#include "world/world.h"

namespace sf::world {

/// The first three leave the row out, or a part of it.
enum class OutlineFault : std::uint8_t { unreadable, empty, points, height, hole };

class OutlineFaults {
 public:
  /// @param strict the first fault is an error
  OutlineFaults(std::string file, bool strict) : file_(std::move(file)), strict_(strict) {}

  /// The first three of a kind become warnings of their own, further ones are counted.
  /// @throws base::InputError where faults are errors
  void add(OutlineFault kind, const OutlineRow& row, const std::string& reason);
  /// Of the whole file; empty: none.
  void note(const std::string& message);
  /// For a file without walls. @throws base::InputError, always, with the first fault. @param columns the file's
  [[noreturn]] void fail(const std::string& columns) const;
  /// All warnings, once.
  std::vector<Warning> take();

 private:
  std::string file_;
  bool strict_;
  std::vector<Warning> warnings_;
  std::array<std::uint64_t, 5> counts_{};  ///< by kind
};

}  // namespace sf::world
