#include "world/stage/unit_hints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sf::world {

namespace {

constexpr double kDegree = M_PI / 180.0;

std::size_t decimals_of(double value) {
  const std::string text = fmt::format("{}", value);  // the shortest text, as a person would write it
  const std::size_t point = text.find('.');
  return point == std::string::npos ? 0 : text.size() - point - 1;
}

/// Returns the multiple of `step` degrees that gives `angle` in radians, rounded or truncated at `digit`; else 0.
double multiple_of(double step, double angle, double digit) {
  const double degrees = step * std::round(angle / kDegree / step);
  const double lost = degrees * kDegree - angle;
  return lost < 1.001 * digit && lost > -0.501 * digit ? degrees : 0.0;
}

/// Returns the range [m] from which on a number is probably in millimetres.
double least_doubtful(std::string_view type) {
  if (type == "infrared" || type == "ir_emitter") return 100.0;
  return type == "sonar" ? 200.0 : 1000.0;  // underwater sonars reach farther than those in air
}

/// Positions of the range's end and of the field of view among the numbers of a property; -1: none.
struct Places {
  int range = -1, fov = -1;
};
Places places_of(std::string_view key) {
  if (key == "view" || key == "sview") return {1, 2};  // [min max fov]
  if (key == "range") return {1, -1};                  // [min max]
  if (key == "range_max" || key == "ir_range") return {0, -1};
  return key == "fov" || key == "ir_fov" || key == "lamp_fov" ? Places{-1, 0} : Places{};
}

}  // namespace

double degrees_of_radians(double angle) {
  const std::size_t decimals = decimals_of(angle);
  const bool quarter = 4.0 * angle == std::floor(4.0 * angle);  // such as 1.75 degrees
  if (!(angle > 0.429 && angle < 6.3) || decimals < 2 || quarter) return 0.0;
  double digit = 1.0;  // the last one, at least 1e-6
  for (std::size_t k = 0; k < std::min<std::size_t>(decimals, 6); ++k) digit *= 0.1;
  double degrees = multiple_of(15.0, angle, 0.01);
  for (const double step : {10.0, 25.0})
    if (degrees == 0.0) degrees = multiple_of(step, angle, digit);
  if (degrees == 0.0 && decimals >= 3) degrees = multiple_of(5.0, angle, digit);
  if (degrees == 0.0 && decimals >= 4) degrees = multiple_of(0.5, angle, digit);
  return degrees;
}

void warn_of_units(BuildState& b, const Property& property, std::string_view type) {
  const Places places = places_of(property.key);
  const auto number = [&](int place) {
    const auto at = static_cast<std::size_t>(place);
    return place >= 0 && at < property.values.size() && !property.values[at].is_text ? property.values[at].number : 0.0;
  };
  std::string text;
  const double fov = number(places.fov), degrees = degrees_of_radians(fov);
  const bool in_degrees = b.context.radians_per_unit != 1.0;
  if (in_degrees && degrees > 0.0)
    text =
        fmt::format("'{}' is in degrees, and {:g} looks like radians: write {:g} if it is", property.key, fov, degrees);
  if (!in_degrees && fov > 6.3)
    text = fmt::format("'{}' is in radians (unit_angle), and {:g} looks like degrees: write {:.4g} if it is",
                       property.key, fov, fov * kDegree);
  const double range = b.context.metres_per_unit * number(places.range);
  if (range >= least_doubtful(type))
    text = fmt::format("'{}' is in metres, and {:g} m looks like millimetres: write {:g} if it is", property.key, range,
                       range / 1000.0);
  const std::string place = fmt::format("units {} {} {}", property.at.file, property.at.line, property.key);
  if (!text.empty() && b.warned_types.insert(place).second) warn(b.context, property.at, text);
}

}  // namespace sf::world
