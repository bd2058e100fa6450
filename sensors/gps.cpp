#include "sensors/gps.h"

#include <bit>
#include <limits>

#include "base/random.h"
#include "sensors/gnss_visibility.h"
#include "sensors/host_backend.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kRate = 1.0;  // [Hz]

struct Receiver {
  double noise = 0.0;  ///< [m]
  std::vector<Satellite> satellites;
};

class GpsReceivers : public HostBackend {
 public:
  GpsReceivers(const SensorContext& context, const ParsedSensors& sensors);

 private:
  void measure(std::span<const HostSample> samples) const override;
  void measure(const HostSample& sample) const;

  GnssVisibility visibility_;
  std::vector<Receiver> receivers_;  ///< per row
};

ParsedSensors parse_receivers(const world::World& world) {
  return parse_each(world, gps_type, [&, top = top_of_blocking(world)](const world::Sensor& sensor, SensorSpec& row) {
    const Gps gps = read_gps(sensor);
    row.sigma = gps.noise > 0.0 ? HUGE_VAL : 0.0;  // depends on the satellites in sight
    row.rate = rate_of(sensor, kRate);
    row.X_MS.z += sensor.height;
    const double above = top - world.movers[row.mover].X_WM.z - row.X_MS.z;
    row.reach = std::max(0.0, above / std::tan(kLeastElevation));
    return gps;
  });
}

GpsReceivers::GpsReceivers(const SensorContext& context, const ParsedSensors& sensors)
    : HostBackend(context, gps_type, sensors), visibility_(context.world) {
  for (const Gps& gps : sensors.settings_as<Gps>())
    receivers_.push_back({context.noise ? gps.noise : 0.0, constellation(gps.satellites)});
}

void GpsReceivers::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) measure(sample);
}

void GpsReceivers::measure(const HostSample& sample) const {
  const Receiver& receiver = receivers_[sample.row];
  const SensorSpec& row = rows()[sample.row];
  const glm::dvec2 p{sample.X_WS.x, sample.X_WS.y};
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < receiver.satellites.size(); ++i)
    if (visibility_.is_visible(p, sample.X_WS.z, receiver.satellites[i])) seen |= std::uint64_t{1} << i;

  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::span<double> out = sample.values;
  out[0] = out[1] = out[2] = kNan;
  out[3] = std::popcount(seen);
  const auto fix = dilution(receiver.satellites, seen);
  if (!fix) return;
  glm::dvec2 error;
  if (receiver.noise > 0.0) {
    const auto [n, m] =
        base::random_normal({seed(), base::RandomStream::satellites, row.mover, row.sensor, sample.sequence}, 0);
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

constinit const SensorType gps_type = plain<kForm>({
    .word = {"gps", kKeys},
    .base_port = 48000,
    .list = "",
    .columns = kColumns,
    .parse = parse_receivers,
    .make = make_backend<GpsReceivers>,
});

}  // namespace sf::sensors
