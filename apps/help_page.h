#pragma once
// The layout of `sensorfarm help` and of the help of a command.

#include <CLI/CLI.hpp>
#include <string>

namespace sf::apps {

/// Commands in groups, those of every day first. A command's help begins with its examples; of a command with many
/// options it has the ten of every day, and `--help-all` has the rest.
class HelpPage : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_subcommands(const CLI::App* app, CLI::AppFormatMode mode) const override;

 private:
  std::string make_everyday(const CLI::App& app) const;
};

}  // namespace sf::apps
