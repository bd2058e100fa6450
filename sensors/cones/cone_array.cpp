#include "sensors/cones/cone_array.h"

#include <fmt/format.h>

#include <cmath>

#include "sensors/elements.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kLongest = 1e4;          // [m] of range_max
constexpr double kShortest = 1e-6;        // [m] of range_max
constexpr std::uint32_t kUsualRays = 11;  // three lanes of four beams

/// Reads `range [min max]`, or the first two numbers of Stage's `sview [min max fov]`.
void read_range(const world::Sensor& sensor, const ConeDefaults& defaults, ConeArray& array) {
  const bool staged = find(sensor, "range") == nullptr && find(sensor, "sview") != nullptr;
  const char* const key = staged ? "sview" : "range";
  const auto values = staged ? tuple(sensor, key, 3, "[min max fov]") : tuple(sensor, key, 2, "[min max]");
  array.range_min = values ? sensor.metres_per_unit * (*values)[0] : defaults.range_min;
  array.range_max = values ? sensor.metres_per_unit * (*values)[1] : defaults.range_max;
  if (array.range_min >= 0.0 && array.range_max > array.range_min && array.range_max >= kShortest &&
      array.range_max <= kLongest)
    return;
  refuse(sensor, key,
         fmt::format("'{}' is [{:g} {:g}] m; expected [min max] with 0 <= min < max, and max from {:g} to {:g} m", key,
                     array.range_min, array.range_max, kShortest, kLongest));
}

double read_fov(const world::Sensor& sensor, double usual) {
  const bool staged = find(sensor, "fov") == nullptr && find(sensor, "sview") != nullptr;
  if (!staged) return angle(sensor, "fov", usual, 0.0, 2.0 * M_PI);
  const double fov = sensor.radians_per_unit * (*tuple(sensor, "sview", 3, "[min max fov]"))[2];
  if (fov >= 0.0 && fov <= 2.0 * M_PI) return fov;
  refuse(sensor, "sview",
         "the third number of 'sview' is its field of view; expected 0 to a whole turn" + hint_of_radians(sensor, fov));
}

std::uint32_t read_rays(const world::Sensor& sensor, double fov) {
  const std::uint32_t rays = whole(sensor, "rays", fov > 0.0 ? kUsualRays : 1, 1, kMostConeRays);
  if (rays % 2 == 1) return rays;
  refuse(sensor, "rays",
         fmt::format("'rays' is {}; expected an odd number, so that one ray lies on the axis of the cone", rays));
}

}  // namespace

ConeArray read_cones(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_type,
                     const ConeDefaults& defaults) {
  ConeArray array;
  array.row = common_spec(sensor, mover, number_of_type);
  array.row.X_MS.z += 0.5 * sensor.height;
  array.row.rate = rate_of(sensor, defaults.rate);
  array.X_SC = read_elements(sensor, kMostTransducers);
  array.row.elements = static_cast<std::uint32_t>(array.X_SC.size());
  array.fov = read_fov(sensor, defaults.fov);
  array.rays = read_rays(sensor, array.fov);
  read_range(sensor, defaults, array);
  array.row.range_min = array.range_min;
  array.row.limit = array.range_max;
  return array;
}

std::vector<ConeArray> cone_arrays_of(const world::World& world, std::string_view type, ReadConeArray read) {
  std::vector<ConeArray> arrays;
  for_each_of(world, type, [&](const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number) {
    arrays.push_back(read(sensor, mover, number));
  });
  return arrays;
}

}  // namespace sf::sensors
