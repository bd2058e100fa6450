#pragma once
// How each subcommand is called: shown at the end of its help.

#include <string>
#include <string_view>

namespace sf::apps {

/// Its examples, one a line, below "Examples:"; empty for a name that has none.
std::string examples_of(std::string_view subcommand);

}  // namespace sf::apps
