#pragma once
// Faults of rows in a file of outlines: warnings with lines, in a bounded number.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "world/outline_rows.h"
#include "world/world.h"

namespace sf::world {

/// The first four leave the row out, or a part of it.
enum class OutlineFault : std::uint8_t { unreadable, empty, points, faces, height, hole, quote };

class OutlineFaults {
 public:
  explicit OutlineFaults(std::string file) : file_(std::move(file)) {}

  /// The first three of a kind become warnings of their own, further ones are counted.
  void add(OutlineFault kind, const OutlineRow& row, const std::string& reason);
  /// Of the whole file, no fault of a row; empty: none.
  void note(const std::string& message);
  /// @throws base::InputError with the first fault, if there is one
  void refuse() const;
  /// For a file without walls. @throws base::InputError, always, with the first fault. @param columns the file's
  [[noreturn]] void fail(const std::string& columns) const;
  /// Faults, then notes.
  std::vector<Warning> warnings() const;

 private:
  struct Fault {
    OutlineFault kind;
    int line;
    std::string reason;
  };
  std::string file_;
  std::vector<Fault> faults_;
  std::array<std::uint64_t, 7> counts_{};  ///< by kind
  std::vector<std::string> notes_;
};

}  // namespace sf::world
