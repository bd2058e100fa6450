#pragma once
// Text for people: messages on standard error, reports on standard output, lines of tables, counts and quantities.

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace sf::apps {

/// From now on standard output is `print`'s alone: what others write there, such as controllers that print, goes to
/// standard error. For output that programs read. To be called before anything is written.
void keep_output_apart();
/// Writes what `print` has written so far. @return false when some of it could not be written
bool flush_output();

/// From now on `print` and `print_message` do nothing: of several ranks, one speaks.
void mute(bool on);
/// To standard output.
void print(const std::string& text);
/// To standard error: "sensorfarm: ", `text` and an end of line.
void print_message(const std::string& text);
template <class... Args>
requires(sizeof...(Args) > 0) void print_message(fmt::format_string<Args...> form, Args&&... args) {
  print_message(fmt::format(form, std::forward<Args>(args)...));
}

/// One line of a table of facts. @param name empty: more of the line before
std::string row(std::string_view name, std::string_view value);
template <class Number>
requires std::is_arithmetic_v<Number> std::string row(std::string_view name, Number value) {
  return row(name, fmt::format("{}", value));
}
template <class... Args>
requires(sizeof...(Args) > 0) std::string row(std::string_view name, fmt::format_string<Args...> form, Args&&... args) {
  return row(name, fmt::format(form, std::forward<Args>(args)...));
}

/// "1 port", "2 ports". @param word takes an s for several
std::string counted(std::uint64_t count, std::string_view word);
/// "a, b or c". @param words at least one
std::string join_or(const std::vector<std::string>& words);
/// "a, b"; "a, b, ... (20 in all)" for more than ten; "none".
std::string list_names(const std::vector<std::string_view>& names);
/// "5 mm", "2.5 uT", "0", "< 1 pm", "-" for infinity; three digits. @param unit "m", "T" or another, which is put
/// behind the number
std::string quantity_text(double value, std::string_view unit);
/// The same of an error bound: never less than it.
std::string bound_text(double bound, std::string_view unit);
/// Three digits of a number >= 0, never less than it.
std::string rounded_up(double value);

}  // namespace sf::apps
