#include "sensors/gyro.h"

#include <algorithm>

#include "sensors/host_backend.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

// Draw numbers of a gyro: one per reading and one per run.
constexpr std::uint32_t kReading = 0;
constexpr std::uint32_t kRun = 1;

class Gyros : public HostBackend {
 public:
  Gyros(const SensorContext& context, const ParsedSensors& sensors);

  void restart(std::uint32_t row, std::int64_t /*now*/) override { gyros_[row] = gyro_of(row); }

 private:
  void measure(std::span<const HostSample> samples) const override;
  GyroModel gyro_of(std::uint32_t row) const;

  const std::vector<Gyro>& settings_;  ///< per row
  bool noise_;
  std::vector<GyroModel> gyros_;  ///< per row
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

Gyros::Gyros(const SensorContext& context, const ParsedSensors& sensors)
    : HostBackend(context, gyro_type, sensors), settings_(sensors.settings_as<Gyro>()), noise_(context.noise) {
  for (std::uint32_t i = 0; i < rows().size(); ++i) gyros_.push_back(gyro_of(i));
}

GyroModel Gyros::gyro_of(std::uint32_t row) const {
  const SensorSpec& spec = rows()[row];
  return {settings_[row], episodes().key(base::RandomStream::gyro, spec.mover, spec.sensor), noise_};
}

void Gyros::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples)
    sample.values[0] = gyros_[sample.row].measure(states()[rows()[sample.row].mover].velocity.turn, sample.sequence);
}

constexpr std::string_view kKeys[] = {"bias", "scale_error", "range", "noise"};
constexpr Column kColumns[] = {{"rate_rad_s"}};
constexpr PlainNumber kNumbers[] = {{1e-6}};
constexpr PlainForm kForm{kGyro, "gyro", kNumbers};

double noise_of_gyro(const ParsedSensors& sensors, std::size_t row, std::uint32_t /*offset*/) {
  return sensors.settings_as<Gyro>()[row].noise;
}

}  // namespace

GyroModel::GyroModel(const Gyro& gyro, const base::RandomKey& draw, bool noise) : draw_(draw), range_(gyro.range) {
  draw_.c = 0;
  if (!noise) return;
  const auto [bias, scale] = base::random_normal(draw_, kRun);
  scale_ = 1.0 + gyro.scale_error * scale;
  bias_ = gyro.bias * bias;
  noise_ = gyro.noise;
}

double GyroModel::measure(double turn, std::uint64_t sequence) const {
  base::RandomKey draw = draw_;
  draw.c = sequence;
  double rate = scale_ * turn + bias_;
  if (noise_ > 0.0) rate += noise_ * base::random_normal(draw, kReading)[0];
  return std::clamp(rate, -range_, range_);
}

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
    .noise = noise_of_gyro,
    .parse = parse_gyros,
    .make = make_backend<Gyros>,
});

}  // namespace sf::sensors
