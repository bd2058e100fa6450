#include "sensors/inclinometer.h"

#include "base/tilted_pose.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"
#include "sensors/triad_backend.h"

namespace sf::sensors {

namespace {

class Inclinometers : public TriadBackend {
 public:
  Inclinometers(const SensorContext& context, const ParsedSensors& sensors)
      : TriadBackend(context, inclinometer_type, sensors, sensors.settings_as<TriadInstrument>(), 4) {}

 private:
  glm::dvec3 truth(std::uint32_t /*row*/, const base::RigidTransform& X_WS) const override {
    const base::Tilt tilt = base::tilted_pose_of(X_WS).tilt;
    return {tilt.roll, tilt.pitch, 0.0};
  }
  void write(const Triad::Output& output, std::span<double> values) const override {
    values[0] = output.values.x, values[1] = output.values.y;
    values[2] = static_cast<double>(output.saturated & 3u);
  }
};

ParsedSensors parse_inclinometers(const world::World& world) {
  return parse_each(world, inclinometer_type, [](const world::Sensor& sensor, SensorSpec& row) {
    return read_instrument(sensor, angle, 4.0, row);
  });
}

constexpr std::string_view kKeys[] = {"pose6", "noise", "bias",         "instability", "walk",
                                      "scale", "step",  "misalignment", "range"};
constexpr Column kColumns[] = {{"roll_rad"}, {"pitch_rad"}, {"saturated", 1, true}};
constexpr PlainNumber kNumbers[] = {{1e-6}, {1e-6}, {1.0, 0.0, 3.0}};
constexpr PlainForm kForm{kInclinometer, "inclinometer", kNumbers};

/// Angles have noise; the word of those that saturated has none.
double noise_of_inclinometer(const ParsedSensors& sensors, std::size_t row, std::uint32_t offset) {
  if (offset >= 2) return HUGE_VAL;
  return reading_noise(sensors.settings_as<TriadInstrument>()[row].errors, sensors.rows[row].rate);
}

}  // namespace

constinit const SensorType inclinometer_type = plain<kForm>({
    .word = {"inclinometer", kKeys},
    .base_port = 13000,
    .list = "",
    .columns = kColumns,
    .noise = noise_of_inclinometer,
    .parse = parse_inclinometers,
    .make = make_backend<Inclinometers>,
});

}  // namespace sf::sensors
