#pragma once
// The command line, read by CLI11 in one source.

#include <optional>

#include "apps/options.h"

namespace sf::apps {

/// Options, or the exit code to end with at once: 0 after --help or --version, 2 after wrong usage (already explained).
struct Parsed {
  Options options;
  std::optional<int> exit_code;
};
Parsed parse_command_line(int argc, const char* const* argv);

}  // namespace sf::apps
