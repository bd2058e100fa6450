#include "sensors/compass.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kMostField = 1.0;  // [T]

class Compasses : public TriadBackend {
 public:
  Compasses(const SensorContext& context, const ParsedSensors& sensors)
      : TriadBackend(context, compass_type, sensors, instruments_of(sensors.settings_as<Compass>()), 2),
        settings_(sensors.settings_as<Compass>()) {}

 private:
  glm::dvec3 truth(std::uint32_t row, const base::RigidTransform& X_WS) const override {
    const Compass& s = settings_[row];
    return s.soft_iron * (glm::transpose(X_WS.R) * s.field_W) + s.hard_iron;
  }
  void write(const Triad::Output& output, std::span<double> values) const override {
    const glm::dvec3& b = output.values;
    const double bearing = base::atan2(b.y, b.x), heading = bearing < 0.0 ? bearing + 2.0 * M_PI : bearing;
    const double row[] = {base::hypot(b.x, b.y, b.z), b.x, b.y, b.z, heading < 2.0 * M_PI ? heading : 0.0};
    std::copy(std::begin(row), std::end(row), values.begin());
  }

  const std::vector<Compass>& settings_;  ///< per row
};

ParsedSensors parse_compasses(const world::World& world) {
  return parse_each(world, compass_type, [&](const world::Sensor& sensor, SensorSpec& row) {
    return read_compass(sensor, world.earth_field, row);
  });
}

/// Reads a tuple of numbers, each of at most `most` either way.
template <std::size_t kSize>
std::array<double, kSize> read_numbers(const world::Sensor& sensor, std::string_view key, const std::string& meaning,
                                       double most) {
  std::array<double, kSize> numbers{};
  const auto written = tuple(sensor, key, kSize, meaning);
  if (!written) return numbers;
  std::copy_n(written->begin(), kSize, numbers.begin());
  for (const double value : numbers)
    if (!(std::abs(value) <= most))
      refuse(sensor, key,
             fmt::format("'{}' has {:g}; expected {}, from {:g} to {:g}", key, value, meaning, -most, most));
  return numbers;
}

/// Returns the field of a compass [T]: that of the world, or as its own settings state.
glm::dvec3 read_field(const world::Sensor& sensor, const glm::dvec3& earth) {
  const bool has_earth = earth != glm::dvec3{};
  if (has_earth && !find(sensor, "strength") && !find(sensor, "inclination") && !find(sensor, "declination"))
    return earth;
  const double flat = base::hypot(earth.x, earth.y);
  const double strength =
      number(sensor, "strength", has_earth ? base::hypot(earth.x, earth.y, earth.z) : 5e-5, 0.0, kMostField);
  const auto [down, level] = base::sin_cos(
      angle(sensor, "inclination", has_earth ? base::atan2(-earth.z, flat) : M_PI / 3.0, -M_PI / 2.0, M_PI / 2.0));
  const auto [east, north] =
      base::sin_cos(angle(sensor, "declination", has_earth ? base::atan2(earth.x, earth.y) : 0.0, -M_PI, M_PI));
  return strength * glm::dvec3{level * east, level * north, -down};
}

constexpr std::string_view kKeys[] = {"pose6",     "strength", "inclination",  "declination", "hard_iron",
                                      "soft_iron", "noise",    "bias",         "instability", "walk",
                                      "scale",     "step",     "misalignment", "range"};
constexpr Column kColumns[] = {{"field_T"}, {"field_x_T"}, {"field_y_T"}, {"field_z_T"}, {"heading_rad"}};
constexpr PlainNumber kReal{.real = true};
constexpr PlainNumber kNumbers[] = {kReal, kReal, kReal, kReal, {1e-6}};
constexpr PlainForm kForm{kCompass, "compass", kNumbers};

/// The noise of the strength is that of an axis, unless other errors distort it; that of the heading depends on the
/// pose.
double noise_of_compass(const ParsedSensors& sensors, std::size_t row, std::uint32_t offset) {
  if (offset == 0) return sensors.rows[row].sigma;
  if (offset > 3) return HUGE_VAL;
  return reading_noise(sensors.settings_as<Compass>()[row].instrument.errors, sensors.rows[row].rate);
}

}  // namespace

Compass read_compass(const world::Sensor& sensor, const glm::dvec3& earth, SensorSpec& row) {
  Compass c{.instrument = read_instrument(sensor, number, kMostField, row)};
  c.field_W = read_field(sensor, earth);
  const auto hard = read_numbers<3>(sensor, "hard_iron", "[x y z] in tesla", kMostField);
  c.hard_iron = {hard[0], hard[1], hard[2]};
  const auto soft = read_numbers<6>(sensor, "soft_iron", "[xx yy zz xy xz yz]", 1.0);
  c.soft_iron += glm::dmat3{{soft[0], soft[3], soft[4]}, {soft[3], soft[1], soft[5]}, {soft[4], soft[5], soft[2]}};
  return c;
}

constinit const SensorType compass_type = plain<kForm>({
    .word = {"compass", kKeys},
    .base_port = 16000,
    .list = "",
    .columns = kColumns,
    .noise = noise_of_compass,
    .parse = parse_compasses,
    .make = make_backend<Compasses>,
});

}  // namespace sf::sensors
