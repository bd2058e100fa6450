#pragma once
// The layout of `sensorfarm help` and of the help of a command.

#include <cstddef>
#include <memory>

namespace CLI {
class FormatterBase;
}  // namespace CLI

namespace sf::apps {

/// Commands in groups, those of every day first. A command's help begins with its examples; of a command with many
/// options it has the ten of every day, and `--help-all` has the rest.
std::shared_ptr<CLI::FormatterBase> help_page(std::size_t column_width);

}  // namespace sf::apps
