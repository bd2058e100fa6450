#pragma once
// Detects memory limits (ulimit -v, -d) as the cause of a crash.

#include <string>

namespace sf::apps {

/// Replaces the text of std::bad_alloc.
inline constexpr const char* kNoMemory = "not enough memory: free some, raise the limit (ulimit -v), or request less";

/// Returns "; memory is limited to 256 MiB (ulimit -v), ..." to append to the description of a crash, since drivers and
/// libraries crash when memory runs out. Empty if neither address space nor data is limited.
std::string memory_limit_note();

}  // namespace sf::apps
