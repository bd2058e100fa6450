#pragma once
// A setting as a command line has it: characters that become a number, a flag, a text or a list when a controller reads
// it, since only the reader knows which it should be: `13.4` is a parking spot's name, `1` a list of one checkpoint.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sf::control {

struct RawText {
  std::string text;
};

// Each takes blanks around the value. Nothing where it is no such value.

/// Finite, in decimal digits.
std::optional<double> read_number(std::string_view raw);
/// "true" or "false".
std::optional<bool> read_flag(std::string_view raw);
/// Without the quotes around it ("..." or '...'), where there are some.
std::string read_text(std::string_view raw);
/// "1,2", "1 2", "[1, 2]", "[1 2]", "1", or "[]" for none.
std::optional<std::vector<double>> read_numbers(std::string_view raw);
/// Likewise; each with quotes or without. Blanks within quotes, and commas there, belong to a text.
std::optional<std::vector<std::string>> read_texts(std::string_view raw);

}  // namespace sf::control
