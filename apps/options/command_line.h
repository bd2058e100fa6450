#pragma once
// The command line, read by CLI11 in one source.

#include <functional>
#include <optional>

namespace sf::apps {

/// The command with its options, or the exit code to end with at once: 0 after --help or --version, 2 after wrong usage
/// (already explained).
struct Parsed {
  std::function<int()> call;
  std::optional<int> exit_code;
};
Parsed parse_command_line(int argc, const char* const* argv);

}  // namespace sf::apps
