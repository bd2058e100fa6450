#pragma once
// Parsers of command-line arguments and the messages for wrong ones. No CLI11 here.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/pose.h"

namespace sf::apps {

/// Each gives what was expected and what came instead, or "" when `text` is fine.

/// A whole number in [first, last], digits only: -1 is not the largest there is.
std::string check_integer(const std::string& text, std::uint64_t first, std::uint64_t last);
/// A number in [first, last]; not-a-number is in no range.
std::string check_number(const std::string& text, double first, double last);
/// One of some words, at least one.
std::string check_choice(const std::string& text, const std::vector<std::string>& words);
/// @param what was expected, with its article.
std::string check_not_empty(const std::string& text, const std::string& what);

/// "a, b or c". @param words at least one.
std::string join_or(const std::vector<std::string>& words);

/// "1 port", "2 ports". @param word takes an s for several
std::string counted(std::uint64_t count, std::string_view word);

/// One line of a table of facts. @param name empty: more of the line before
std::string row(std::string_view name, std::string_view value);

/// "X,Y,YAW_DEG" [m, m, degrees], each within 1e7, as a pose; nothing where it is none.
std::optional<base::Pose> read_pose(const std::string& text);

/// "X0,Y0,X1,Y1" [m], each within 1e7 and the two points distinct; nothing where it is none.
std::optional<std::array<double, 4>> read_line(const std::string& text);

/// "52000" or "52000-52016" (both ends included, at most 1024) as ports from 1 on; empty where it is neither.
std::vector<std::uint16_t> read_ports(const std::string& text);

/// A length or a flux density with its unit, such as "5mm" or "2uT", above 0.
struct Quantity {
  double value = 0.0;  ///< [m] or [T]
  bool is_tesla = false;
};
std::optional<Quantity> read_quantity(const std::string& text);
/// "5 mm", "2.5 uT", "0", "< 1 pm", "-" for infinity; three digits. @param unit "m", "T" or another, which is put
/// behind the number
std::string quantity_text(double value, std::string_view unit);

/// "10" or "10Hz", above 0.
std::optional<double> read_rate(const std::string& text);

/// Suggestion for the unexpected argument `word`: `; did you mean '--x'?`, or empty.
/// @param names of the subcommand's options, without dashes.
std::string suggest_option(const std::string& word, const std::vector<std::string>& names);

}  // namespace sf::apps
