#pragma once
// Rewrites messages. Messages of the farm name options of the command line; those of the library must name its own
// (sensorfarm::Options, and the arguments of Python, which have the same names).

#include <string>

namespace sf::library {

/// Returns `message` with the library's options in place of those of the command line.
std::string in_own_words(std::string message);

}  // namespace sf::library
