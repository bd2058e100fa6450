#include "sensors/gyro.h"

#include <algorithm>

#include "base/random.h"
#include "sensors/host_instruments.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

// Draws of one gyro: its run's own, and each reading's.
constexpr std::uint32_t kReading = 0;
constexpr std::uint32_t kRun = 1;

/// One gyro of a run.
struct Fixed {
  double range = 0.0;
  double scale = 1.0;
  double bias = 0.0;
  double noise = 0.0;
};

base::RandomKey draw_of(std::uint64_t seed, const SensorRow& row, std::uint64_t sequence) {
  return {seed, base::RandomStream::gyro, row.mover, row.sensor, sequence};
}

class Gyros : public HostInstruments {
 public:
  explicit Gyros(const SensorContext& context);

  void follow(std::span<const base::Report> states, std::int64_t, bool) override {
    for (std::size_t m = 0; m < states.size(); ++m) turns_[m] = states[m].velocity.turn;
  }

 private:
  void measure(std::span<const Sight> sights) const override;

  std::vector<Fixed> gyros_;   ///< per row
  std::vector<double> turns_;  ///< [rad/s] per mover
};

std::vector<SensorRow> rows_of(const world::World& world) {
  std::vector<SensorRow> rows;
  for_each_sensor(world, gyro_kind, [&](const Fitted& fitted) {
    rows.push_back(fitted.row);
    rows.back().limit = read_gyro(fitted.settings).range;
  });
  return rows;
}

Gyros::Gyros(const SensorContext& context)
    : HostInstruments(context, gyro_kind, rows_of(context.world)), turns_(context.world.movers.size(), 0.0) {
  for_each_sensor(context.world, gyro_kind, [&](const Fitted& fitted) {
    const Gyro gyro = read_gyro(fitted.settings);
    Fixed fixed{.range = gyro.range};
    if (context.noise) {
      const auto [bias, scale] = base::random_normal(draw_of(context.seed, fitted.row, 0), kRun);
      fixed = {gyro.range, 1.0 + gyro.scale_error * scale, gyro.bias * bias, gyro.noise};
    }
    gyros_.push_back(fixed);
  });
}

void Gyros::measure(std::span<const Sight> sights) const {
  for (const Sight& sight : sights) {
    const SensorRow& row = rows()[sight.row];
    const Fixed& gyro = gyros_[sight.row];
    double rate = gyro.scale * turns_[row.mover] + gyro.bias;
    if (gyro.noise > 0.0) rate += gyro.noise * base::random_normal(draw_of(seed(), row, sight.sequence), kReading)[0];
    sight.values[0] = std::clamp(rate, -gyro.range, gyro.range);
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

constinit const SensorKind gyro_kind = plain<kForm>({
    .word = {"gyro", kKeys},
    .base_port = 46000,
    .list = "",
    .columns = kColumns,
    .rows = rows_of,
    .make = make_instruments<Gyros>,
});

}  // namespace sf::sensors
