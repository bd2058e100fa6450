#pragma once
// Tokens of a Stage world file, each with its line.

#include <string>
#include <string_view>
#include <vector>

namespace sf::world {

enum class TokenKind { word, number, text, open, close, open_tuple, close_tuple, end };

struct Token {
  TokenKind kind = TokenKind::end;
  std::string text;     ///< as written; strings without quotes
  double number = 0.0;  ///< finite; for numbers only
  int line = 0;         ///< 1-based
};

/// Splits `text` into tokens; the last one is `end`. Comments run from `#` to the end of the line. Lines end with LF,
/// CR or CRLF.
/// @param file name for errors
/// @throws base::InputError for an unterminated string, a malformed number, or a character outside the format
std::vector<Token> tokenize(const std::string& file, std::string_view text);

}  // namespace sf::world
