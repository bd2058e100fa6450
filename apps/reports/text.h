#pragma once
// Text output: messages on standard error, reports on standard output, table rows, counts and quantities.

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace sf::apps {

/// Reserves standard output for `print`: output of other code, such as controllers that print, is redirected to
/// standard error. For output that programs parse. Call before anything is written.
void keep_output_apart();
/// Flushes the output of `print`. @return false if some of it could not be written
bool flush_output();

/// Disables `print` and `print_message`, so that only one of several ranks prints.
void mute(bool on);
/// Prints to standard output.
void print(const std::string& text);
/// Prints "sensorfarm: ", `text` and a line end to standard error.
void print_message(const std::string& text);
template <class... Args>
requires(sizeof...(Args) > 0) void print_message(fmt::format_string<Args...> form, Args&&... args) {
  print_message(fmt::format(form, std::forward<Args>(args)...));
}

/// Formats one line of a table of facts. @param name empty: continues the line before
std::string row(std::string_view name, std::string_view value);
template <class Number>
requires std::is_arithmetic_v<Number> std::string row(std::string_view name, Number value) {
  return row(name, fmt::format("{}", value));
}
template <class... Args>
requires(sizeof...(Args) > 0) std::string row(std::string_view name, fmt::format_string<Args...> form, Args&&... args) {
  return row(name, fmt::format(form, std::forward<Args>(args)...));
}

/// Returns "1 port", "2 ports". @param word gets an s for the plural
std::string counted(std::uint64_t count, std::string_view word);
/// Returns "a, b or c". @param words at least one
std::string join_or(const std::vector<std::string>& words);
/// Returns "a, b"; "a, b, ... (20 in all)" for more than ten names; "none" for an empty list.
std::string list_names(const std::vector<std::string_view>& names);
/// Returns a quantity with three digits: "5 mm", "2.5 uT", "0", "< 1 pm"; "-" for infinity. @param unit "m" or "T", or
/// another unit, which has no prefix
std::string quantity_text(double value, std::string_view unit);
/// The same for an error bound, which is rounded up.
std::string bound_text(double bound, std::string_view unit);
/// Returns three digits of a number >= 0, rounded up.
std::string rounded_up(double value);

}  // namespace sf::apps
