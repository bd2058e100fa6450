#pragma once
// Parses the command line with CLI11, which only the source includes.

#include <functional>
#include <optional>

namespace sf::apps {

/// The command with its options, or an exit code if there is nothing to run: 0 after --help or --version, 2 after a
/// usage error, which has been printed.
struct Parsed {
  std::function<int()> call;
  std::optional<int> exit_code;
};
Parsed parse_command_line(int argc, const char* const* argv);

}  // namespace sf::apps
