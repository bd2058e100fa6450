#pragma once
// Parsers of command-line arguments, and validators with error messages. Does not depend on CLI11.

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/options/tilted_pose.h"
#include "base/pose.h"
#include "viz/paths.h"
#include "world/world.h"

namespace sf::apps {

/// Returns an error for the argument ("expected ..., got ..."), or "".
using Validator = std::function<std::string(const std::string&)>;

/// Accepts an integer in [first, last], decimal digits only: -1 does not wrap to the largest integer.
Validator whole(std::uint64_t first, std::uint64_t last);
/// Accepts a number in [first, last]; rejects NaN.
Validator number(double first, double last);
/// The same for a time; the message states the unit.
Validator in_seconds(double first, double last);
/// Accepts the folder or file of a recorded run; rejects worlds, scenarios and tables.
Validator recording();
/// @param words at least one
Validator one_of(std::vector<std::string> words);
/// @param expected with its article
Validator not_empty(const std::string& expected);
/// Accepts a file to write; rejects folders. @param example file name for the error message
Validator new_file(const std::string& example);
/// Accepts a picture file to write, with a suffix that viz::format_of supports.
Validator picture();
/// The same for a file that a command rewrites while it runs: its folder must exist, and an existing file must be a
/// regular one.
Validator replaced_picture();
/// Accepts a video file to write.
Validator video();
/// Accepts an argument that `read` can parse. @param expected with its article
template <class Read>
Validator readable(Read read, const char* expected) {
  return [=](const std::string& text) {
    return read(text) ? std::string() : fmt::format("expected {}, got '{}'", expected, text);
  };
}

// Each function returns nullopt if the text has another form.

/// "KEY=VALUE".
std::optional<std::pair<std::string, std::string>> read_setting(const std::string& text);
/// "X,Y,YAW_DEG" [m, m, degrees], each within 1e7.
std::optional<base::Pose> read_pose(const std::string& text);
/// Reads the same, or "X,Y,Z,ROLL_DEG,PITCH_DEG,YAW_DEG".
std::optional<TiltedPose> read_tilted_pose(const std::string& text);
/// "X,Y,Z" [m], each a length of a shape (base::is_shape_length).
std::optional<std::array<double, 3>> read_lengths(const std::string& text);
/// "X0,Y0,X1,Y1" [m], each within 1e7; two distinct points.
std::optional<viz::Line> read_line(const std::string& text);
/// "XMIN,YMIN,XMAX,YMAX" [m], each within 1e7; not empty.
std::optional<world::Extent> read_extent(const std::string& text);
/// "85" or "170x120" [mm] as width in [85, 1000] and height in [60, 1000]; the height is 0 if omitted.
std::optional<glm::dvec2> read_size(const std::string& text);
/// "1280x720" [px], both even, in [16, 4096].
std::optional<std::pair<int, int>> read_pixels(const std::string& text);
/// "52000" or "52000-52016" as ports from 1 on, both ends included, at most 1024 ports.
std::optional<std::vector<std::uint16_t>> read_ports(const std::string& text);

/// A positive length or flux density with its unit, such as "5mm" or "2uT".
struct Quantity {
  double value = 0.0;  ///< [m] or [T]
  bool is_tesla = false;
};
std::optional<Quantity> read_quantity(const std::string& text);
/// "10" or "10Hz", above 0.
std::optional<double> read_rate(const std::string& text);

/// Returns a suggestion for the unexpected argument `word`, `; did you mean '--x'?`, or "".
/// @param names of the subcommand's options, without dashes.
std::string suggest_option(const std::string& word, const std::vector<std::string>& names);

}  // namespace sf::apps
