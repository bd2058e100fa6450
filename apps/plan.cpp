#include "apps/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace sf::apps {

namespace {

std::optional<double> number_of(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == ',')
      words.emplace_back();
    else
      words.back() += c;
  }
  return words;
}

control::Value value_of(const std::string& text) {
  if (text == "true" || text == "false") return text == "true";
  if (const auto value = number_of(text)) return *value;
  if (text.find(',') == std::string::npos) return text;
  const std::vector<std::string> words = words_of(text);
  std::vector<double> numbers;
  for (const std::string& word : words)
    if (const auto value = number_of(word)) numbers.push_back(*value);
  if (numbers.size() == words.size()) return numbers;
  return words;
}

}  // namespace

control::Setting setting_of(const std::string& text) {
  const std::size_t at = text.find('=');
  const std::string key = text.substr(0, at);
  return {key, value_of(text.substr(at + 1)), fmt::format("--set {}: ", key)};
}

control::Plan plan_of(const Options& options) {
  std::vector<control::Setting> settings;
  for (const std::string& text : options.set) settings.push_back(setting_of(text));
  return {options.controller, 0.0,
          control::Settings(fmt::format("controller '{}'", options.controller), std::move(settings))};
}

}  // namespace sf::apps
