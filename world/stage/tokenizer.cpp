#include "world/stage/tokenizer.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "base/error.h"

namespace sf::world {

namespace {

// Far above any real world, so that a broken file does not exhaust memory.
constexpr std::size_t kMaxTokens = 8'000'000;
constexpr std::size_t kLongestToken = 10'000;

struct Scanner {
  const std::string& file;
  std::string_view text;
  std::size_t at = 0;
  int line = 1;
  std::vector<Token> tokens;
};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_line_end(char c) { return c == '\n' || c == '\r'; }
bool starts_number(char c) { return is_digit(c) || c == '+' || c == '-' || c == '.'; }

/// Adds the token from `begin` to the current position. @param value of a number
void add(Scanner& s, TokenKind kind, std::size_t begin, double value = 0.0) {
  const std::size_t length = s.at - begin;
  if (length > kLongestToken)
    throw base::InputError(s.file, s.line,
                           fmt::format("a word or text of {} characters; expected at most {}", length, kLongestToken));
  if (s.tokens.size() >= kMaxTokens)
    throw base::InputError(
        s.file, s.line, fmt::format("more than {} words, numbers and brackets; expected fewer in a file", kMaxTokens));
  s.tokens.push_back({kind, std::string(s.text.substr(begin, length)), value, s.line});
}

char peek(const Scanner& s, std::size_t ahead = 0) {
  return s.at + ahead < s.text.size() ? s.text[s.at + ahead] : '\0';
}

// `[12]` directly after a word is its index; any other bracket opens a tuple.
std::size_t index_length(const Scanner& s) {
  std::size_t n = 1;
  while (is_digit(peek(s, n))) ++n;
  return n > 1 && peek(s, n) == ']' ? n + 1 : 0;
}

void scan_word(Scanner& s) {
  const std::size_t begin = s.at;
  while (s.at < s.text.size()) {
    const char c = s.text[s.at];
    if (is_letter(c) || is_digit(c) || c == '.' || c == '-' || c == '_') {
      ++s.at;
    } else if (const std::size_t index = c == '[' ? index_length(s) : 0; index > 0) {
      s.at += index;
    } else {
      break;
    }
  }
  add(s, TokenKind::word, begin);
}

void scan_number(Scanner& s) {
  const std::size_t begin = s.at;
  while (s.at < s.text.size() && (is_letter(s.text[s.at]) || starts_number(s.text[s.at]))) ++s.at;
  const std::string written(s.text.substr(begin, s.at - begin));

  const char* first = written.data() + (written[0] == '+' ? 1 : 0);
  const char* last = written.data() + written.size();
  double value = 0.0;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error != std::errc() || end != last || !std::isfinite(value)) {
    throw base::InputError(s.file, s.line, fmt::format("'{}' is not a number (expected e.g. 0.25)", written));
  }
  add(s, TokenKind::number, begin, value);
}

void scan_string(Scanner& s) {
  const std::size_t begin = ++s.at;
  while (s.at < s.text.size() && s.text[s.at] != '"' && !is_line_end(s.text[s.at])) ++s.at;
  if (peek(s) != '"') {
    throw base::InputError(s.file, s.line, "this string has no closing quote; expected \" before the end of the line");
  }
  add(s, TokenKind::text, begin);
  ++s.at;
}

// Skips blanks, line ends and comments. Returns false at any other character.
bool skip_blank(Scanner& s) {
  const char c = s.text[s.at];
  if (is_line_end(c)) {
    if (c == '\r' && peek(s, 1) == '\n') ++s.at;
    ++s.at;
    ++s.line;
    return true;
  }
  if (c == '#') {
    while (s.at < s.text.size() && !is_line_end(s.text[s.at])) ++s.at;
    return true;
  }
  if (c == ' ' || c == '\t' || c == '\v' || c == '\f') {
    ++s.at;
    return true;
  }
  return false;
}

bool scan_bracket(Scanner& s) {
  TokenKind kind = TokenKind::end;
  switch (s.text[s.at]) {
    case '(':
      kind = TokenKind::open;
      break;
    case ')':
      kind = TokenKind::close;
      break;
    case '[':
      kind = TokenKind::open_tuple;
      break;
    case ']':
      kind = TokenKind::close_tuple;
      break;
    default:
      return false;
  }
  ++s.at;
  add(s, kind, s.at - 1);
  return true;
}

[[noreturn]] void refuse_character(const Scanner& s) {
  const char c = s.text[s.at];
  if (c == ',') throw base::InputError(s.file, s.line, "unexpected ','; separate values by blanks: [1 2 3]");
  const bool printable = c > ' ' && c < '\x7f';
  const std::string shown = printable ? std::string(1, c) : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  throw base::InputError(
      s.file, s.line,
      fmt::format("unexpected '{}'; expected a word, a number, a \"string\", a bracket or # and a comment", shown));
}

}  // namespace

std::vector<Token> tokenize(const std::string& file, std::string_view text) {
  Scanner s{file, text, 0, 1, {}};
  if (text.starts_with("\xEF\xBB\xBF")) s.at = 3;  // skips a byte order mark
  while (s.at < s.text.size()) {
    if (skip_blank(s) || scan_bracket(s)) continue;
    const char c = s.text[s.at];
    if (is_letter(c)) {
      scan_word(s);
    } else if (starts_number(c)) {
      scan_number(s);
    } else if (c == '"') {
      scan_string(s);
    } else {
      refuse_character(s);
    }
  }
  s.tokens.push_back({TokenKind::end, "", 0.0, s.line});
  return std::move(s.tokens);
}

}  // namespace sf::world
