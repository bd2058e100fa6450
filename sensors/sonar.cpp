#include "sensors/sonar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "sensors/cones/rangers.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"
#include "shaders/sonar.comp.h"

namespace sf::sensors {

namespace {

constexpr double kDegrees = M_PI / 180.0;
constexpr double kLongest = 1e4;    // [m] limit of noise and ranges
constexpr double kMostShare = 1e3;  // limit of proportional noise

/// ARIA's firing order: one transducer of each array per reading.
std::uint32_t read_turns(const world::Sensor& sensor, std::uint32_t transducers) {
  constexpr std::string_view kFirings[] = {"sequential", "all"};
  const bool all = choice(sensor, "firing", 0, kFirings) == 1;
  const std::uint32_t arrays = whole(sensor, "arrays", 1, 1, transducers);
  if (transducers % arrays != 0)
    refuse(sensor, "arrays",
           fmt::format("'arrays {}' does not divide the {} transducers of 'scount' evenly; arrays fire in parallel, "
                       "each with one transducer at a time",
                       arrays, transducers));
  return all ? 1 : transducers / arrays;
}

void read_noise(const world::Sensor& sensor, ConeArray& array) {
  const auto values = tuple(sensor, "noise", 1, "[constant proportional]");
  if (!values) return;
  array.sigma = sensor.metres_per_unit * (*values)[0];
  array.proportional = values->size() > 1 ? (*values)[1] : 0.0;
  array.row.sigma = base::hypot(array.sigma, array.proportional * array.range_max);
  if (array.sigma >= 0.0 && array.sigma <= kLongest && array.proportional >= 0.0 && array.proportional <= kMostShare)
    return;
  refuse(sensor, "noise",
         fmt::format("'noise' is [{:g} {:g}]; expected [constant proportional], a length up to {:g} m and a share of "
                     "the range up to {:g}, neither of them negative",
                     (*values)[0], array.proportional, kLongest, kMostShare));
}

void tell_range(const ConeArray& array, double range, bool met, double deviate, std::span<double> out) {
  const double sigma = base::hypot(array.sigma, array.proportional * range);
  out[0] = std::clamp(met ? range + sigma * deviate : range, array.range_min, array.range_max);
}

constexpr RangerType kRanger{kSonar, 1, {"sonar", sonar_comp_spv, true}, tell_range};

constexpr std::string_view kKeys[] = {"scount", "spose[]", "spose3[]", "ssize",  "sview",     "fov",
                                      "range",  "rays",    "firing",   "arrays", "incidence", "noise"};
constexpr Column kColumns[] = {{"range_m"}};
constexpr PlainNumber kNumbers[] = {{1e-3, 0.0, kLongest, true}};
constexpr PlainForm kForm{kSonar, "sonar", kNumbers};

}  // namespace

ConeArray read_sonar(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_type) {
  ConeArray array = read_cones(sensor, mover, number_of_type, {25.0 * kDegrees, 0.10, 4.0, 25.0});
  array.turns = read_turns(sensor, array.row.elements);
  const double incidence = angle(sensor, "incidence", 0.5 * M_PI, 1e-3 * kDegrees, 0.5 * M_PI);
  array.min_cosine = incidence < 0.5 * M_PI * (1.0 - 1e-12) ? base::cos(incidence) : 0.0;
  read_noise(sensor, array);
  return array;
}

constinit const SensorType sonar_type = plain<kForm>({
    .word = {"sonar", kKeys},
    .base_port = 36000,
    .list = "transducers",
    .columns = kColumns,
    .parse = [](const world::World& world) { return parse_rangers(world, sonar_type.word.type, read_sonar); },
    .make = make_ranger_backend<kRanger>,
});

}  // namespace sf::sensors
