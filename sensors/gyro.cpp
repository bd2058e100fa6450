#include "sensors/gyro.h"

#include <algorithm>

#include "base/random.h"
#include "sensors/host_backend.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

// Draw numbers of a gyro: one per reading and one per run.
constexpr std::uint32_t kReading = 0;
constexpr std::uint32_t kRun = 1;

/// Constants of a gyro in a run.
struct Fixed {
  double range = 0.0;
  double scale = 1.0;
  double bias = 0.0;
  double noise = 0.0;
};

base::RandomKey draw_of(std::uint64_t seed, const SensorSpec& row, std::uint64_t sequence) {
  return {seed, base::RandomStream::gyro, row.mover, row.sensor, sequence};
}

class Gyros : public HostBackend {
 public:
  Gyros(const SensorContext& context, const ParsedSensors& sensors);

 private:
  void measure(std::span<const HostSample> samples) const override;

  std::vector<Fixed> gyros_;  ///< per row
};

ParsedSensors parse_gyros(const world::World& world) {
  return parse_each(world, gyro_type, [](const world::Sensor& sensor, SensorSpec& row) {
    const Gyro gyro = read_gyro(sensor);
    row.limit = gyro.range;
    row.sigma = gyro.bias > 0.0 || gyro.scale_error > 0.0 ? HUGE_VAL : gyro.noise;
    row.reach = 0.0;
    return gyro;
  });
}

Gyros::Gyros(const SensorContext& context, const ParsedSensors& sensors) : HostBackend(context, gyro_type, sensors) {
  for (std::size_t i = 0; i < rows().size(); ++i) {
    const Gyro& gyro = sensors.settings_as<Gyro>()[i];
    Fixed fixed{.range = gyro.range};
    if (context.noise) {
      const auto [bias, scale] = base::random_normal(draw_of(context.seed, rows()[i], 0), kRun);
      fixed = {gyro.range, 1.0 + gyro.scale_error * scale, gyro.bias * bias, gyro.noise};
    }
    gyros_.push_back(fixed);
  }
}

void Gyros::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) {
    const SensorSpec& row = rows()[sample.row];
    const Fixed& gyro = gyros_[sample.row];
    double rate = gyro.scale * states()[row.mover].velocity.turn + gyro.bias;
    if (gyro.noise > 0.0) rate += gyro.noise * base::random_normal(draw_of(seed(), row, sample.sequence), kReading)[0];
    sample.values[0] = std::clamp(rate, -gyro.range, gyro.range);
  }
}

constexpr std::string_view kKeys[] = {"bias", "scale_error", "range"};
constexpr Column kColumns[] = {{"rate_rad_s"}};
constexpr PlainNumber kNumbers[] = {{1e-6}};
constexpr PlainForm kForm{kGyro, "gyro", kNumbers};

}  // namespace

Gyro read_gyro(const world::Sensor& sensor) {
  Gyro g;
  constexpr double kMost = 1e3;  // [rad/s]
  g.bias = angle(sensor, "bias", 0.0, 0.0, kMost);
  g.noise = angle(sensor, "noise", 0.0, 0.0, kMost);
  g.scale_error = number(sensor, "scale_error", 0.0, 0.0, 1.0);
  g.range = angle(sensor, "range", g.range, 1e-6, kMost);
  return g;
}

constinit const SensorType gyro_type = plain<kForm>({
    .word = {"gyro", kKeys},
    .base_port = 46000,
    .list = "",
    .columns = kColumns,
    .parse = parse_gyros,
    .make = make_backend<Gyros>,
});

}  // namespace sf::sensors
