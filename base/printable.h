#pragma once
// Makes untrusted text, such as names and exception messages, safe for terminals.

#include <string>
#include <string_view>

namespace sf::base {

/// Replaces control characters (including DEL and U+0080 to U+009F) and invalid UTF-8 with \xNN. Keeps line breaks and
/// tabs.
std::string printable(std::string_view text);

/// Same, but also replaces each run of line breaks, tabs and carriage returns with a blank.
std::string one_line(std::string_view text);

}  // namespace sf::base
