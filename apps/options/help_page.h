#pragma once
// Layout of `sensorfarm help` and of each command's help.

#include <cstddef>
#include <memory>

namespace CLI {
class FormatterBase;
}  // namespace CLI

namespace sf::apps {

/// Lists the commands in groups, the most common group first. A command's help starts with examples. A command with
/// many options shows its ten most common ones; `--help-all` shows the rest.
std::shared_ptr<CLI::FormatterBase> help_page(std::size_t column_width);

}  // namespace sf::apps
