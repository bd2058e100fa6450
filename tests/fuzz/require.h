#pragma once
// What must hold for any input of a fuzz target.

#include <cstdio>
#include <cstdlib>
#include <source_location>

namespace sf {

/// Ends the target with file and line where it does not hold.
inline void require(bool holds, std::source_location at = std::source_location::current()) {
  if (holds) return;
  std::fprintf(stderr, "%s:%u: does not hold\n", at.file_name(), static_cast<unsigned>(at.line()));
  std::abort();
}

}  // namespace sf
