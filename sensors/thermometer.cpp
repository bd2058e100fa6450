#include "sensors/thermometer.h"

#include <cmath>

#include "base/elementary.h"
#include "base/random.h"
#include "sensors/host_backend.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

// Draw numbers of a thermometer: one per reading and one per run.
constexpr std::uint32_t kNoiseDraw = 0, kBiasDraw = 1;
constexpr double kMostError = 1e3;  // [K]

class Thermometers : public HostBackend {
 public:
  Thermometers(const SensorContext& context, const ParsedSensors& sensors)
      : HostBackend(context, thermometer_type, sensors),
        settings_(sensors.settings_as<Thermometer>()),
        noisy_(context.noise) {}

 private:
  void measure(std::span<const HostSample> samples) const override {
    for (const HostSample& sample : samples)
      sample.values[0] = temperature_at(world(), {sample.X_WS.x, sample.X_WS.y}) + error_of(sample);
  }

  double error_of(const HostSample& sample) const {
    if (!noisy_) return 0.0;
    const SensorSpec& row = rows()[sample.row];
    base::RandomKey draw = episodes().key(base::RandomStream::thermometers, row.mover, row.sensor);
    const Thermometer& s = settings_[sample.row];
    double error = s.bias > 0.0 ? s.bias * base::random_normal(draw, kBiasDraw)[0] : 0.0;
    draw.c = sample.sequence;
    if (s.noise > 0.0) error += s.noise * base::random_normal(draw, kNoiseDraw)[0];
    return error;
  }

  const std::vector<Thermometer>& settings_;  ///< per row
  bool noisy_;
};

ParsedSensors parse_thermometers(const world::World& world) {
  return parse_each(world, thermometer_type, [](const world::Sensor& sensor, SensorSpec& row) {
    const Thermometer s{number(sensor, "noise", 0.0, 0.0, kMostError), number(sensor, "bias", 0.0, 0.0, kMostError)};
    row.sigma = base::hypot(s.noise, s.bias);
    row.reach = 0.0;
    return s;
  });
}

constexpr std::string_view kKeys[] = {"bias", "noise"};
constexpr Column kColumns[] = {{"temperature_C"}};
constexpr PlainNumber kNumbers[] = {{1e-3}};
constexpr PlainForm kForm{kThermometer, "thermometer", kNumbers};

}  // namespace

double temperature_at(const world::World& world, const glm::dvec2& p) {
  double sum = world.temperature;
  for (const world::HeatSource& source : world.heat_sources) {
    const glm::dvec2 to = (p - source.p) / source.radius;
    sum += source.rise * base::exp(-0.5 * glm::dot(to, to));
  }
  return sum;
}

constinit const SensorType thermometer_type = plain<kForm>({
    .word = {"thermometer", kKeys},
    .base_port = 22000,
    .list = "",
    .columns = kColumns,
    .parse = parse_thermometers,
    .make = make_backend<Thermometers>,
});

}  // namespace sf::sensors
