#pragma once
// Messages of the farm name options of the command line. Those of the library name its own (sensorfarm::Options, and
// the arguments of Python, which have the same names).

#include <string>

namespace sf::library {

/// `message` with the library's options in place of those of the command line.
std::string in_own_words(std::string message);

}  // namespace sf::library
