#pragma once
// Words and numbers of text mesh files.

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string_view>
#include <system_error>

namespace sf::world {

/// Reads the words of a text, separated by white space.
class WordReader {
 public:
  explicit WordReader(std::string_view text) : rest_(text) {}

  /// Returns the next word, or an empty one at the end.
  std::string_view word() {
    const auto is_space = [](char c) {
      return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
    };
    std::size_t first = 0;
    while (first < rest_.size() && is_space(rest_[first])) lines_ += rest_[first++] == '\n';
    std::size_t end = first;
    while (end < rest_.size() && !is_space(rest_[end])) ++end;
    const std::string_view found = rest_.substr(first, end - first);
    rest_.remove_prefix(end);
    return found;
  }
  /// Reads the next word as a number. @return false for another word
  template <class Number>
  bool number(Number& out) {
    std::string_view text = word();
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
    return error == std::errc() && end == text.data() + text.size();
  }
  void skip_line() { rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size())); }
  std::string_view rest() const { return rest_; }
  std::uint64_t line() const { return lines_ + 1; }  ///< of the last word, from 1

 private:
  std::string_view rest_;
  std::uint64_t lines_ = 0;
};

/// Returns whether `word` in lower case equals `lower`.
inline bool is_word(std::string_view word, std::string_view lower) {
  return std::equal(word.begin(), word.end(), lower.begin(), lower.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b; });
}

/// Returns a text without white space at its ends.
inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n\f\v";
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  return text.substr(0, text.find_last_not_of(kSpace) + 1);
}

/// Takes the next line of a text, without its end. @return false after the last
inline bool take_line(std::string_view& text, std::string_view& line) {
  if (text.empty()) return false;
  const std::size_t end = text.find('\n');
  line = text.substr(0, end);
  if (line.ends_with('\r')) line.remove_suffix(1);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return true;
}

}  // namespace sf::world
