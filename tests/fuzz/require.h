#pragma once
// The check used by fuzz targets.

#include <cstdio>
#include <cstdlib>

namespace sf {

/// Ends the fuzzer, which keeps the input, if `condition` is false. clang 14 has no std::source_location.
inline void require(bool condition, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if (condition) return;
  std::fprintf(stderr, "%s:%d: does not hold\n", file, line);
  std::abort();
}

}  // namespace sf
