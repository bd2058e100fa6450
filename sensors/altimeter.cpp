#include "sensors/altimeter.h"

#include "sensors/plain_packets.h"
#include "sensors/settings.h"
#include "sensors/triad_backend.h"

namespace sf::sensors {

namespace {

constexpr double kMostHeight = 1e6;  // [m]

struct Altimeter {
  TriadInstrument instrument;
  double datum = 0.0;  ///< [m] height in the world that reads 0
};

class Altimeters : public TriadBackend {
 public:
  Altimeters(const SensorContext& context, const ParsedSensors& sensors)
      : TriadBackend(context, altimeter_type, sensors, instruments_of(sensors.settings_as<Altimeter>()), 3),
        settings_(sensors.settings_as<Altimeter>()) {}

 private:
  glm::dvec3 truth(std::uint32_t row, const base::RigidTransform& X_WS) const override {
    return {X_WS.p.z - settings_[row].datum, 0.0, 0.0};
  }
  void write(const Triad::Output& output, std::span<double> values) const override { values[0] = output.values.x; }

  const std::vector<Altimeter>& settings_;  ///< per row
};

ParsedSensors parse_altimeters(const world::World& world) {
  return parse_each(world, altimeter_type, [](const world::Sensor& sensor, SensorSpec& row) {
    return Altimeter{read_instrument(sensor, length, kMostHeight, row),
                     length(sensor, "datum", 0.0, -kMostHeight, kMostHeight)};
  });
}

constexpr std::string_view kKeys[] = {"pose6", "datum", "noise", "bias", "instability",
                                      "walk",  "scale", "step",  "range"};
constexpr Column kColumns[] = {{"height_m"}};
constexpr PlainNumber kNumbers[] = {{1e-3}};
constexpr PlainForm kForm{kAltimeter, "altimeter", kNumbers};

double noise_of_altimeter(const ParsedSensors& sensors, std::size_t row, std::uint32_t /*offset*/) {
  return reading_noise(sensors.settings_as<Altimeter>()[row].instrument.errors, sensors.rows[row].rate);
}

}  // namespace

constinit const SensorType altimeter_type = plain<kForm>({
    .word = {"altimeter", kKeys},
    .base_port = 32000,
    .list = "",
    .columns = kColumns,
    .noise = noise_of_altimeter,
    .parse = parse_altimeters,
    .make = make_backend<Altimeters>,
});

}  // namespace sf::sensors
