#pragma once
// A small route network with all elements, as a base for broken variants.

#include <string>
#include <string_view>

#include "tests/refusal.h"
#include "world/roads/rndf.h"

namespace sf::world {

inline constexpr std::string_view kSmallRndf = R"(RNDF_name small
num_segments 2
num_zones 1
format_version 1.0
creation_date 1-Jan-07
segment 1
num_lanes 2
segment_name Main_Street
lane 1.1
num_waypoints 3
lane_width 12
left_boundary double_yellow
right_boundary solid_white
checkpoint 1.1.2 1
stop 1.1.3
exit 1.1.3 2.1.1
1.1.1 40.000000 -83.000000
1.1.2 40.000000 -82.999000
1.1.3 40.000000 -82.998000
end_lane
lane 1.2
num_waypoints 2
lane_width 12
left_boundary double_yellow
right_boundary broken_white
1.2.1 40.000050 -82.998000
1.2.2 40.000050 -83.000000
end_lane
end_segment
segment 2
num_lanes 1
lane 2.1
num_waypoints 2
exit 2.1.2 3.0.1
2.1.1 40.000100 -82.997900
2.1.2 40.001000 -82.997900
end_lane
end_segment
zone 3
num_spots 1
zone_name Lot
perimeter 3.0
num_perimeterpoints 4
exit 3.0.3 1.2.1
3.0.1 40.001100 -82.997900
3.0.2 40.001100 -82.997000
3.0.3 40.001600 -82.997000
3.0.4 40.001600 -82.997900
end_perimeter
spot 3.1
spot_width 10
checkpoint 3.1.2 2
3.1.1 40.001300 -82.997500
3.1.2 40.001350 -82.997500
end_spot
end_zone
end_file
)";

/// Returns `text` with its first `from` replaced by `to`. Fails the test if there is none.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  SF_CHECK(at != std::string::npos, "nothing to replace: " + from);
  return text.replace(at, from.size(), to);
}

/// Returns the small network with its first `from` replaced by `to`.
inline std::string small_with(const std::string& from, const std::string& to) {
  return with(std::string(kSmallRndf), from, to);
}

inline Rndf small_rndf() { return parse_rndf("small.rndf", kSmallRndf); }

/// Returns the error, in strict mode by default; empty if the file is read.
inline std::string refusal_of(const std::string& text, bool strict = true) {
  return sf::refusal_of([&] { parse_rndf("small.rndf", text, strict); });
}

/// Returns one warning per line: "3: ...".
inline std::string lines_of(const std::vector<Warning>& warnings) {
  std::string all;
  for (const Warning& warning : warnings) all += std::to_string(warning.line) + ": " + warning.message + "\n";
  return all;
}

}  // namespace sf::world
