#include "sensors/monitor.h"

#include <algorithm>
#include <cmath>

#include "sensors/plain_packets.h"
#include "sensors/pose_sensor.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

class MonitorSensor final : public PoseSensor<estimation::LocalizationMonitor> {
 public:
  using PoseSensor::PoseSensor;

  void read(double seconds, sensorfarm::DerivedReading out) override {
    const std::int64_t time = base::nanoseconds(seconds);
    begin(time);
    flush();
    filter_.update(time);
    PoseSensor::read(seconds, out);
    const base::Twist& velocity = filter_.predict(time).estimate.velocity;
    const bool valid = out.valid[0] != 0;
    // The place of these columns without `valid` and the covariance.
    double* extra = out.values.data() + 3;
    *extra++ = valid ? velocity.forward : NAN;
    *extra++ = valid ? velocity.turn : NAN;
    for (const auto input : estimation::kEachMonitoredInput) *extra++ = static_cast<double>(filter_.state(input));
    for (const auto input : estimation::kEachMonitoredInput) *extra++ = filter_.residual(input);
  }
};

constexpr const char* kThresholdsMeaning =
    "[turn wheels course reckoned (fast), the same four (slow), roughness], nine numbers above 0";

std::unique_ptr<sensorfarm::DerivedSensor> make_monitor(const DerivedContext& context) {
  const PositionSensors sensors = position_inputs(context);
  if (context.inputs.size() < 2 || (!sensors.wheels && !sensors.gps))
    refuse(context.settings, "inputs", "a monitor compares sensors: it needs two or three of encoder, gyro and gps");
  estimation::MonitorOptions options;
  options.hold = number(context.settings, "hold", options.hold, 0.0, 3600.0);
  if (const auto limits = tuple(context.settings, "thresholds", 9, kThresholdsMeaning)) {
    if (limits->size() != 9 || !std::ranges::all_of(*limits, [](double v) { return v > 0.0; }))
      refuse(context.settings, "thresholds", std::string("'thresholds' expects ") + kThresholdsMeaning);
    estimation::MonitorThresholds& to = options.thresholds;
    std::copy_n(limits->begin(), to.fast.size(), to.fast.begin());
    std::copy_n(limits->begin() + 4, to.slow.size(), to.slow.begin());
    to.roughness = limits->back();
  }
  return std::make_unique<MonitorSensor>(context,
                                         monitor_of(context.world.movers[context.spec.mover], sensors, options));
}

constexpr DerivedPort kPorts[] = {{"encoder", kEncoderColumns}, {"gyro", kGyroColumns}, {"gps", kGpsColumns}};
constexpr DerivedForm kDerived{.ports = kPorts, .quantities = 3, .covariance = true, .extra = 8, .make = make_monitor};

constexpr std::string_view kKeys[] = {kDerivedKeys[0], kDerivedKeys[1], "thresholds", "hold"};
constexpr auto kColumns = joined(kPoseRow, std::array<Column, 8>{{{"forward_m_s"},
                                                                  {"turn_rad_s"},
                                                                  {"encoder_state", 1, true},
                                                                  {"gyro_state", 1, true},
                                                                  {"gps_state", 1, true},
                                                                  {"encoder_residual"},
                                                                  {"gyro_residual"},
                                                                  {"gps_residual"}}});
constexpr PlainNumber kState{1.0, 0.0, 3.0};
constexpr auto kNumbers =
    joined(kPoseForms, std::array<PlainNumber, 8>{kReal, kReal, kState, kState, kState, kReal, kReal, kReal});
constexpr PlainForm kForm{kMonitor, "monitor", kNumbers};

}  // namespace

estimation::LocalizationMonitor monitor_of(const world::Mover& mover, const PositionSensors& sensors,
                                           estimation::MonitorOptions monitor) {
  for (std::size_t kind = 0; kind < sensors.periods.size(); ++kind) {
    if (sensors.periods[kind] > 0.0) monitor.period[kind] = sensors.periods[kind];
    monitor.latency[kind] = sensors.latencies[kind];
  }
  estimation::LocalizationOptions options = localization_options(mover, sensors);
  options.gyro.scale = 0.0;  // its thresholds include errors of the scale
  return {options, monitor, sensors.gyro.has_value(), sensors.gps.has_value()};
}

constinit const SensorType monitor_type = plain<kForm>({
    .word = {"monitor", kKeys, {}, true},
    .base_port = 4000,
    .list = "",
    .columns = kColumns,
    .derived = &kDerived,
    .parse = [](const world::World& world) { return parse_derived(world, monitor_type, 1, 20.0); },
    .make = no_backend,
});

}  // namespace sf::sensors
