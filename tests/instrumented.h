#pragma once
// Instrumented modules (AddressSanitizer, UBSan) are several times slower: large scenes are made smaller for them.

#include <cstdlib>

namespace sf {

/// The modules or the tests are built with sanitizers. tests/CMakeLists.txt sets the variable for the former.
inline bool instrumented() {
#if defined(__SANITIZE_ADDRESS__)
  return true;
#else
  return std::getenv("SENSORFARM_INSTRUMENTED") != nullptr;
#endif
}

}  // namespace sf
