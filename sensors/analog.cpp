#include "sensors/analog.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensors/host_backend.h"
#include "sensors/illumination.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kMostVolts = 1e3;

class AnalogInputs : public HostBackend {
 public:
  AnalogInputs(const SensorContext& context, const ParsedSensors& sensors)
      : HostBackend(context, analog_type, sensors),
        settings_(sensors.settings_as<Analog>()),
        illumination_(context.world) {}

 private:
  void measure(std::span<const HostSample> samples) const override;

  const std::vector<Analog>& settings_;  ///< per row
  Illumination illumination_;
};

void AnalogInputs::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) {
    const Analog& a = settings_[sample.row];
    const double steps = std::ldexp(1.0, static_cast<int>(a.bits)) - 1.0;
    for (std::size_t i = 0; i < a.inputs.size(); ++i) {
      const AnalogInput& input = a.inputs[i];
      const double volts = input.source == AnalogInput::Source::light
                               ? input.gain * illumination_.at(sample.X_WS, input.X_SE)
                               : input.gain;
      sample.values[2 * i] = std::clamp(volts, a.least, a.most);
      sample.values[2 * i + 1] = std::floor((sample.values[2 * i] - a.least) / (a.most - a.least) * steps + 0.5);
    }
  }
}

AnalogInput read_input(const world::Sensor& sensor, std::uint32_t i) {
  AnalogInput input;
  if (const auto p = tuple(sensor, fmt::format("spose[{}]", i), 3, "[x y yaw]"))
    input.X_SE = {sensor.metres_per_unit * (*p)[0], sensor.metres_per_unit * (*p)[1], 0.0,
                  sensor.radians_per_unit * (*p)[2]};
  const std::string key = fmt::format("input[{}]", i);
  const world::Setting* setting = find(sensor, key);
  if (setting == nullptr) return input;
  const bool light = setting->text == "light";
  if (setting->numbers.size() != 1 || !(light || setting->text == "constant"))
    refuse(sensor, key, fmt::format("'{}' expects [\"constant\" volts] or [\"light\" volts-per-lux]", key));
  input.source = light ? AnalogInput::Source::light : AnalogInput::Source::constant;
  input.gain = setting->numbers[0];
  if (std::abs(input.gain) <= kMostVolts) return input;
  refuse(sensor, key, fmt::format("'{}' is {:g}; expected -{:g} to {:g}", key, input.gain, kMostVolts, kMostVolts));
}

ParsedSensors parse_analogs(const world::World& world) {
  return parse_each(world, analog_type, [reach = reach_of_lamps(world)](const world::Sensor& sensor, SensorSpec& row) {
    Analog settings = read_analog(sensor);
    row.X_MS.z += 0.5 * sensor.height;
    row.elements = static_cast<std::uint32_t>(settings.inputs.size());
    row.reach = reach;
    return settings;
  });
}

constexpr std::string_view kKeys[] = {"inputs", "input[]", "spose[]", "range", "bits"};
constexpr Column kColumns[] = {{"voltage_V"}, {"value", 1, true}};
constexpr PlainNumber kNumbers[] = {{1e-4}, {1.0, 0.0, 65535.0}};
constexpr PlainForm kForm{kAnalog, "analog", kNumbers};

}  // namespace

Analog read_analog(const world::Sensor& sensor) {
  Analog a;
  const std::uint32_t count = whole(sensor, "inputs", 1, 1, kMostAnalogInputs);
  refuse_beyond(sensor, "input[", "inputs", count, kMostAnalogInputs);
  refuse_beyond(sensor, "spose[", "inputs", count, kMostAnalogInputs);
  for (std::uint32_t i = 0; i < count; ++i) a.inputs.push_back(read_input(sensor, i));
  a.bits = whole(sensor, "bits", a.bits, 1, kMostAnalogBits);
  if (const auto range = tuple(sensor, "range", 2, "[min max] in volts")) {
    a.least = (*range)[0];
    a.most = (*range)[1];
    if (!(a.least < a.most && std::max(-a.least, a.most) <= kMostVolts))
      refuse(sensor, "range",
             fmt::format("'range' is [{:g} {:g}]; expected [min max] in volts with min below max, both within {:g}",
                         a.least, a.most, kMostVolts));
  }
  return a;
}

constinit const SensorType analog_type = plain<kForm>({
    .word = {"analog", kKeys},
    .base_port = 58000,
    .list = "inputs",
    .columns = kColumns,
    .parse = parse_analogs,
    .make = make_backend<AnalogInputs>,
});

}  // namespace sf::sensors
