#pragma once
// Parsers of command-line arguments, and checks with messages for wrong ones. No CLI11 here.

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.h"
#include "viz/paths.h"
#include "world/world.h"

namespace sf::apps {

/// The error of an argument ("expected ..., got ..."), or "".
using Validator = std::function<std::string(const std::string&)>;

/// A whole number in [first, last], decimal digits only: -1 is not the largest there is.
Validator whole(std::uint64_t first, std::uint64_t last);
/// A number in [first, last]; not-a-number is in no range.
Validator number(double first, double last);
/// The same for a time, whose message states the unit.
Validator in_seconds(double first, double last);
/// The folder or file of a recorded run: no world, scenario or table.
Validator recording();
/// @param words at least one
Validator one_of(std::vector<std::string> words);
/// @param expected with its article
Validator not_empty(const std::string& expected);
/// A file that is written: no folder. @param example its name in the advice
Validator new_file(const std::string& example);
/// A file that a picture is written to: its suffix is one of viz::format_of.
Validator picture();
/// A file that a video is written to.
Validator video();
/// An argument that `read` understands. @param expected with its article
template <class Read>
Validator readable(Read read, const char* expected) {
  return [=](const std::string& text) {
    return read(text) ? std::string() : fmt::format("expected {}, got '{}'", expected, text);
  };
}

// Each returns nullopt for text of another form.

/// "KEY=VALUE".
std::optional<std::pair<std::string, std::string>> read_setting(const std::string& text);
/// "X,Y,YAW_DEG" [m, m, degrees], each within 1e7.
std::optional<base::Pose> read_pose(const std::string& text);
/// "X0,Y0,X1,Y1" [m], each within 1e7; two distinct points.
std::optional<viz::Line> read_line(const std::string& text);
/// "XMIN,YMIN,XMAX,YMAX" [m], each within 1e7; not empty.
std::optional<world::Extent> read_extent(const std::string& text);
/// "85" or "170x120" [mm] as width in [85, 1000] and height in [60, 1000]; the height is 0 where there is none.
std::optional<glm::dvec2> read_size(const std::string& text);
/// "1280x720" [px], both even, in [16, 4096].
std::optional<std::pair<int, int>> read_pixels(const std::string& text);
/// "52000" or "52000-52016" (both ends included, at most 1024) as ports from 1 on.
std::optional<std::vector<std::uint16_t>> read_ports(const std::string& text);

/// A length or a flux density with its unit, such as "5mm" or "2uT", above 0.
struct Quantity {
  double value = 0.0;  ///< [m] or [T]
  bool is_tesla = false;
};
std::optional<Quantity> read_quantity(const std::string& text);
/// "10" or "10Hz", above 0.
std::optional<double> read_rate(const std::string& text);

/// Suggestion for the unexpected argument `word`: `; did you mean '--x'?`, or empty.
/// @param names of the subcommand's options, without dashes.
std::string suggest_option(const std::string& word, const std::vector<std::string>& names);

}  // namespace sf::apps
