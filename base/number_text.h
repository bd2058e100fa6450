#pragma once
// Numbers as texts.

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>

namespace sf::base {

/// Returns the number that the whole text is, as of std::from_chars; nullopt if there is more or less to it.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// The same for numbers that are neither infinite nor NaN.
inline std::optional<double> finite_number(std::string_view text) {
  const std::optional<double> value = number_of<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

}  // namespace sf::base
