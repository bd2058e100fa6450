#pragma once
// Words of a Stage world file: the flat stream of tokens, each with its line.

#include <string>
#include <string_view>
#include <vector>

namespace sf::world {

enum class TokenKind { word, number, text, open, close, open_tuple, close_tuple, end };

struct Token {
  TokenKind kind = TokenKind::end;
  std::string text;     ///< as written; a string without its quotes
  double number = 0.0;  ///< finite; of a number only
  int line = 0;         ///< 1-based
};

/// Cuts `text` into tokens; the last one is `end`. Comments run from `#` to the end of the line; LF, CR and CRLF end
/// lines.
/// @param file named in errors.
/// @throws base::InputError for a string without end, a number that is none, a character that no world file has.
std::vector<Token> tokenize(const std::string& file, std::string_view text);

}  // namespace sf::world
