#include "sensors/infrared.h"

#include <algorithm>
#include <cmath>

#include "sensors/cones/rangers.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"
#include "shaders/infrared.comp.h"

namespace sf::sensors {

namespace {

constexpr double kDegrees = M_PI / 180.0;

/// Implements Webots' table for the Khepera II: the response falls linearly with the range, and its relative noise
/// grows linearly.
void tell_response(const ConeArray& array, double range, bool met, double deviate, std::span<double> out) {
  const double away = (std::max(range, array.range_min) - array.range_min) / (array.range_max - array.range_min);
  const double quiet = met ? kMostResponse * (1.0 - away) : 0.0;
  const double response = std::clamp(quiet * (1.0 + array.proportional * away * deviate), 0.0, kMostResponse);
  const double said = array.range_max - (array.range_max - array.range_min) * (response / kMostResponse);
  out[0] = deviate == 0.0 ? std::max(range, array.range_min) : std::clamp(said, array.range_min, array.range_max);
  out[1] = std::floor(response + 0.5);
}

constexpr RangerType kRanger{kInfrared, kInfraredColumns, {"infrared", infrared_comp_spv, false}, tell_response};

constexpr std::string_view kKeys[] = {"scount", "spose[]", "spose3[]", "ssize", "sview",
                                      "fov",    "range",   "rays",     "noise"};
constexpr Column kColumns[] = {{"range_m"}, {"value", 1, true}};
constexpr PlainNumber kNumbers[] = {{1e-6, 0.0, 1e4, true}, {1.0, 0.0, kMostResponse}};
constexpr PlainForm kForm{kInfrared, "infrared", kNumbers};

}  // namespace

double infrared_response(double range, const base::RangeLimits& limits) {
  const double away = (range - limits.min) / (limits.max - limits.min);
  return std::floor(kMostResponse * (1.0 - std::clamp(away, 0.0, 1.0)) + 0.5);
}

double infrared_sigma(double range, const base::RangeLimits& limits, double noise) {
  const double span = limits.max - limits.min, away = std::clamp((range - limits.min) / span, 0.0, 1.0);
  return span * (1.0 - away) * noise * away;
}

ConeArray read_infrared(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_type) {
  ConeArray array = read_cones(sensor, mover, number_of_type, {30.0 * kDegrees, 0.0, 0.05, 50.0});
  array.proportional = number(sensor, "noise", 0.0, 0.0, 1e3);
  array.row.sigma = array.proportional > 0.0 ? HUGE_VAL : 0.0;  // noise of the response
  return array;
}

constinit const SensorType infrared_type = plain<kForm>({
    .word = {"infrared", kKeys},
    .base_port = 38000,
    .list = "elements",
    .columns = kColumns,
    .parse = [](const world::World& world) { return parse_rangers(world, infrared_type.word.type, read_infrared); },
    .make = make_ranger_backend<kRanger>,
});

}  // namespace sf::sensors
