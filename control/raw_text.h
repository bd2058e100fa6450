#pragma once
// A setting as given on the command line: text without a type. The controller that reads it determines the type: `13.4`
// may be the name of a parking spot, `1` a list of one checkpoint.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sf::control {

struct RawText {
  std::string text;
};

// Each function allows blanks around the value, and returns nullopt for text of another form.

/// Reads a finite number in decimal digits.
std::optional<double> read_number(std::string_view raw);
/// Reads "true" or "false".
std::optional<bool> read_flag(std::string_view raw);
/// Strips one pair of quotes ("..." or '...') around the text, if any.
std::string read_text(std::string_view raw);
/// Reads "1,2", "1 2", "[1, 2]", "[1 2]", "1", or "[]" for none.
std::optional<std::vector<double>> read_numbers(std::string_view raw);
/// Reads a list of texts in the same forms, each with or without quotes. Blanks and commas within quotes belong to the
/// text.
std::optional<std::vector<std::string>> read_texts(std::string_view raw);

}  // namespace sf::control
