#include "control/raw_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace sf::control {

namespace {

constexpr std::string_view kBlanks = " \t";

std::string_view trim(std::string_view raw) {
  const std::size_t first = raw.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return raw.substr(first, raw.find_last_not_of(kBlanks) - first + 1);
}

bool is_quote(char c) { return c == '"' || c == '\''; }

bool is_quoted(std::string_view word) {
  return word.size() >= 2 && is_quote(word.front()) && word.back() == word.front();
}

/// Returns the words between separators outside of quotes, trimmed.
std::vector<std::string_view> split(std::string_view raw, std::string_view separators) {
  std::vector<std::string_view> words;
  char open = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    if (open != 0) {
      if (raw[i] == open) open = 0;
    } else if (is_quote(raw[i])) {
      open = raw[i];
    } else if (separators.find(raw[i]) != std::string_view::npos) {
      words.push_back(trim(raw.substr(begin, i - begin)));
      begin = i + 1;
    }
  }
  words.push_back(trim(raw.substr(begin)));
  return words;
}

/// Returns words separated by commas or, without commas, by blanks; nullopt for a comma without a word next to it or an
/// unbalanced bracket.
std::optional<std::vector<std::string_view>> words_of(std::string_view raw) {
  raw = trim(raw);
  const bool opens = raw.starts_with('['), closes = raw.ends_with(']');
  if (opens != closes || raw.empty()) return std::nullopt;
  if (opens) raw = trim(raw.substr(1, raw.size() - 2));
  if (raw.empty()) return std::vector<std::string_view>{};
  std::vector<std::string_view> words = split(raw, ",");
  if (words.size() > 1) {
    if (std::find(words.begin(), words.end(), "") != words.end()) return std::nullopt;
    return words;
  }
  words = split(raw, kBlanks);
  words.erase(std::remove(words.begin(), words.end(), ""), words.end());
  return words;
}

}  // namespace

std::optional<double> read_number(std::string_view raw) {
  raw = trim(raw);
  double value = 0.0;
  const char* const end = raw.data() + raw.size();
  const auto [stop, error] = std::from_chars(raw.data(), end, value);
  return error == std::errc() && stop == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<bool> read_flag(std::string_view raw) {
  raw = trim(raw);
  return raw == "true" || raw == "false" ? std::optional(raw == "true") : std::nullopt;
}

std::string read_text(std::string_view raw) {
  raw = trim(raw);
  return std::string(is_quoted(raw) ? raw.substr(1, raw.size() - 2) : raw);
}

std::optional<std::vector<double>> read_numbers(std::string_view raw) {
  const auto words = words_of(raw);
  if (!words) return std::nullopt;
  std::vector<double> numbers;
  for (const std::string_view word : *words) {
    const auto number = read_number(word);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::optional<std::vector<std::string>> read_texts(std::string_view raw) {
  const auto words = words_of(raw);
  if (!words) return std::nullopt;
  std::vector<std::string> texts;
  for (const std::string_view word : *words) texts.push_back(read_text(word));
  return texts;
}

}  // namespace sf::control
