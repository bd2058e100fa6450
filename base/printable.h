#pragma once
// Texts from outside, such as names and messages of exceptions, for terminals.

#include <string>
#include <string_view>

namespace sf::base {

/// `text` with \xNN in place of control characters (also DEL, and those of U+0080 to U+009F) and of invalid UTF-8.
/// Line breaks and tabs stay.
std::string printable(std::string_view text);

/// The same with a blank for each run of line breaks, tabs and carriage returns.
std::string one_line(std::string_view text);

}  // namespace sf::base
