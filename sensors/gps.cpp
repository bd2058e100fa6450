#include "sensors/gps.h"

#include <bit>
#include <limits>

#include "base/random.h"
#include "sensors/host_instruments.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"
#include "sensors/sky.h"

namespace sf::sensors {

namespace {

constexpr double kRate = 1.0;  // [Hz]

struct Receiver {
  double noise = 0.0;  ///< [m]
  std::vector<Satellite> satellites;
};

class GpsReceivers : public HostInstruments {
 public:
  explicit GpsReceivers(const SensorContext& context);

 private:
  void measure(std::span<const Sight> sights) const override;
  void measure(const Sight& sight) const;

  Sky sky_;
  std::vector<Receiver> receivers_;  ///< per row
};

std::vector<SensorRow> rows_of(const world::World& world) {
  std::vector<SensorRow> rows;
  for_each_sensor(world, gps_kind, [&](const Fitted& fitted) {
    read_gps(fitted.settings);
    SensorRow row = fitted.row;
    row.rate = rate_of(fitted.settings, kRate);
    row.X_MS.z += fitted.settings.height;
    rows.push_back(row);
  });
  return rows;
}

GpsReceivers::GpsReceivers(const SensorContext& context)
    : HostInstruments(context, gps_kind, rows_of(context.world)), sky_(context.world) {
  for_each_sensor(context.world, gps_kind, [&](const Fitted& fitted) {
    const Gps gps = read_gps(fitted.settings);
    receivers_.push_back({context.noise ? gps.noise : 0.0, constellation(gps.satellites)});
  });
}

void GpsReceivers::measure(std::span<const Sight> sights) const {
  for (const Sight& sight : sights) measure(sight);
}

void GpsReceivers::measure(const Sight& sight) const {
  const Receiver& receiver = receivers_[sight.row];
  const SensorRow& row = rows()[sight.row];
  const glm::dvec2 p{sight.X_WS.x, sight.X_WS.y};
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < receiver.satellites.size(); ++i)
    if (sky_.sees(p, sight.X_WS.z, receiver.satellites[i])) seen |= std::uint64_t{1} << i;

  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::span<double> out = sight.values;
  out[0] = out[1] = out[2] = kNan;
  out[3] = std::popcount(seen);
  const auto fix = dilution(receiver.satellites, seen);
  if (!fix) return;
  glm::dvec2 error;
  if (receiver.noise > 0.0) {
    const auto [n, m] =
        base::random_normal({seed(), base::RandomStream::satellites, row.mover, row.sensor, sight.sequence}, 0);
    error = receiver.noise * glm::dvec2{fix->xx * n, fix->yx * n + fix->yy * m};
  }
  out[0] = p.x + error.x;
  out[1] = p.y + error.y;
  out[2] = fix->hdop;
}

constexpr std::string_view kKeys[] = {"satellites"};
constexpr Column kColumns[] = {{"x_m"}, {"y_m"}, {"hdop"}, {"satellites", 1, true}};
constexpr PlainNumber kNumbers[] = {{5e-3}, {5e-3}, {1e-3, 0.0}, {1.0, 0.0, kMostSatellites}};
constexpr PlainForm kForm{kGps, "gps", kNumbers};

}  // namespace

Gps read_gps(const world::Sensor& sensor) {
  Gps gps;
  gps.satellites = whole(sensor, "satellites", gps.satellites, 4, kMostSatellites);
  gps.noise = length(sensor, "noise", 0.0, 0.0, 1e6);
  return gps;
}

constinit const SensorKind gps_kind = plain<kForm>({
    .word = {"gps", kKeys},
    .base_port = 48000,
    .list = "",
    .columns = kColumns,
    .rows = rows_of,
    .make = make_instruments<GpsReceivers>,
});

}  // namespace sf::sensors
