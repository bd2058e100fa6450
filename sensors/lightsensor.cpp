#include "sensors/lightsensor.h"

#include <algorithm>
#include <cmath>

#include "sensors/elements.h"
#include "sensors/host_backend.h"
#include "sensors/illumination.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

class LightSensors : public HostBackend {
 public:
  LightSensors(const SensorContext& context, const ParsedSensors& sensors)
      : HostBackend(context, lightsensor_type, sensors),
        settings_(sensors.settings_as<LightSensor>()),
        illumination_(context.world) {}

 private:
  void measure(std::span<const HostSample> samples) const override;
  const std::vector<LightSensor>& settings_;  ///< per row
  Illumination illumination_;
};

void LightSensors::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) {
    const LightSensor& s = settings_[sample.row];
    for (std::size_t i = 0; i < s.X_SE.size(); ++i) {
      const double light = illumination_.at(sample.X_WS, s.X_SE[i]);
      sample.values[2 * i] = light;
      sample.values[2 * i + 1] = std::floor(s.dark * std::max(0.0, 1.0 - light / s.bright) + 0.5);
    }
  }
}

LightSensor read_light_sensor(const world::Sensor& sensor) {
  LightSensor s;
  s.X_SE = read_elements(sensor, kMostLightElements);
  s.dark = number(sensor, "dark", s.dark, 0.0, kMostLightValue);
  s.bright = number(sensor, "bright", s.bright, 1e-3, 1e9);
  return s;
}

ParsedSensors parse_light_sensors(const world::World& world) {
  return parse_each(world, lightsensor_type,
                    [reach = reach_of_lamps(world)](const world::Sensor& sensor, SensorSpec& row) {
                      LightSensor settings = read_light_sensor(sensor);
                      row.X_MS.z += 0.5 * sensor.height;
                      row.elements = static_cast<std::uint32_t>(settings.X_SE.size());
                      row.reach = reach;
                      return settings;
                    });
}

constexpr std::string_view kKeys[] = {"scount", "spose[]", "spose3[]", "ssize", "dark", "bright"};
constexpr Column kColumns[] = {{"illuminance_lx"}, {"value", 1, true}};
constexpr PlainNumber kNumbers[] = {{1e-3, 0.0}, {1.0, 0.0, kMostLightValue}};
constexpr PlainForm kForm{kLightSensor, "lightsensor", kNumbers};

}  // namespace

constinit const SensorType lightsensor_type = plain<kForm>({
    .word = {"lightsensor", kKeys},
    .base_port = 54000,
    .list = "elements",
    .columns = kColumns,
    .parse = parse_light_sensors,
    .make = make_backend<LightSensors>,
});

}  // namespace sf::sensors
