#pragma once
// Collects faults of rows in a file of outlines: warnings with line numbers, limited in number.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "world/outline_rows.h"
#include "world/world.h"

namespace sf::world {

/// With the first four, the row or a part of it is left out.
enum class OutlineFault : std::uint8_t { unreadable, empty, points, faces, height, hole, quote };

class OutlineFaults {
 public:
  explicit OutlineFaults(std::string file) : file_(std::move(file)) {}

  /// The first three of a kind become separate warnings; further ones are counted.
  void add(OutlineFault kind, const OutlineRow& row, const std::string& reason);
  /// Adds a remark on the whole file, which is not a fault of a row; empty: none.
  void note(const std::string& message);
  /// @throws base::InputError with the first fault, if there is one
  void refuse() const;
  /// Throws base::InputError with the first fault, for a file without walls. @param columns of the file
  [[noreturn]] void fail(const std::string& columns) const;
  /// Returns warnings for the faults, then the notes.
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
