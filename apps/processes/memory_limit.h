#pragma once
// Limits of memory (ulimit -v, -d) as the cause of a crash.

#include <string>

namespace sf::apps {

/// In place of the text of std::bad_alloc.
inline constexpr const char* kNoMemory = "not enough memory: free some, raise the limit (ulimit -v), or ask for less";

/// "; memory is limited to 256 MiB (ulimit -v), ...", to be put behind how a process was ended: drivers and libraries
/// crash where memory ends. Empty: neither addresses nor data are limited.
std::string memory_limit_note();

}  // namespace sf::apps
