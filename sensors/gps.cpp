#include "sensors/gps.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "base/elementary.h"
#include "base/rigid_transform.h"
#include "base/tilted_pose.h"
#include "sensors/host_backend.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::uint32_t kPlanarNumbers = 4;  // of readings without an altitude

class GpsReceivers : public HostBackend {
 public:
  GpsReceivers(const SensorContext& context, const ParsedSensors& sensors);

 private:
  void measure(std::span<const HostSample> samples) const override;
  Pose antenna_of(const HostSample& sample) const;

  const std::vector<Gps>& settings_;  ///< per row
  GnssVisibility visibility_;
  std::vector<GpsModel> receivers_;  ///< per row
};

ParsedSensors parse_receivers(const world::World& world) {
  ParsedSensors sensors =
      parse_each(world, gps_type, [&, top = top_of_blocking(world)](const world::Sensor& sensor, SensorSpec& row) {
        const Gps gps = read_gps(sensor);
        row.sigma = gps.noise > 0.0 ? HUGE_VAL : 0.0;  // depends on the satellites in sight
        row.rate = rate_of(sensor, kGpsRate);
        row.X_MS.z += sensor.height;
        const double above = top - world.movers[row.mover].X_WM.z - row.X_MS.z;
        row.reach = std::max(0.0, above / base::tan(kLeastElevation));
        return gps;
      });
  const bool altitude = std::ranges::any_of(sensors.settings_as<Gps>(), &Gps::altitude);
  for (SensorSpec& row : sensors.rows) row.width = altitude ? 0 : kPlanarNumbers;
  return sensors;
}

GpsReceivers::GpsReceivers(const SensorContext& context, const ParsedSensors& sensors)
    : HostBackend(context, gps_type, sensors), settings_(sensors.settings_as<Gps>()), visibility_(context.world) {
  for (const Gps& gps : sensors.settings_as<Gps>())
    receivers_.push_back({context.noise ? gps.noise : 0.0, constellation(gps.satellites)});
}

/// The antenna of a tilted robot leans with it.
Pose GpsReceivers::antenna_of(const HostSample& sample) const {
  const SensorSpec& row = rows()[sample.row];
  const base::Report& state = states()[row.mover];
  if (base::is_level(state.tilt)) return sample.X_WS;
  const glm::dvec3 p =
      base::transform(base::transform_of(state.X_WM, state.tilt), {row.X_MS.x, row.X_MS.y, row.X_MS.z});
  return {p.x, p.y, p.z, sample.X_WS.yaw};
}

void GpsReceivers::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) {
    const SensorSpec& row = rows()[sample.row];
    auto reading = receivers_[sample.row].measure(
        visibility_, episodes().key(base::RandomStream::satellites, row.mover, row.sensor, sample.sequence),
        antenna_of(sample));
    if (!settings_[sample.row].altitude) reading[4] = reading[5] = NAN;
    std::copy_n(reading.begin(), sample.values.size(), sample.values.begin());
  }
}

constexpr std::string_view kKeys[] = {"satellites", "noise", "altitude"};
constexpr Column kColumns[] = {{"x_m"}, {"y_m"}, {"hdop"}, {"satellites", 1, true}, {"altitude_m"}, {"vdop"}};
constexpr PlainNumber kNumbers[] = {{5e-3}, {5e-3}, {1e-3, 0.0}, {1.0, 0.0, kMostSatellites}, {5e-3}, {1e-3, 0.0}};
constexpr PlainForm kForm{kGps, "gps", kNumbers, kPlanarNumbers};

}  // namespace

std::array<double, 6> GpsModel::measure(const GnssVisibility& visibility, const base::RandomKey& draw,
                                        const Pose& X_WS) const {
  const glm::dvec2 p{X_WS.x, X_WS.y};
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < satellites.size(); ++i)
    if (visibility.is_visible(p, X_WS.z, satellites[i])) seen |= std::uint64_t{1} << i;

  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const double count = std::popcount(seen);
  const auto fix = dilution(satellites, seen);
  if (!fix) return {kNan, kNan, kNan, count, kNan, kNan};
  glm::dvec2 error{};
  double up = 0.0;
  if (noise > 0.0) {
    const auto [n, m] = base::random_normal(draw, 0);
    error = noise * glm::dvec2{fix->xx * n, fix->yx * n + fix->yy * m};
    up = fix->zx * error.x + fix->zy * error.y + noise * fix->zz * base::random_normal(draw, 1)[0];
  }
  return {p.x + error.x, p.y + error.y, fix->hdop, count, X_WS.z + up, fix->vdop};
}

Gps read_gps(const world::Sensor& sensor) {
  Gps gps;
  gps.satellites = whole(sensor, "satellites", gps.satellites, 4, kMostSatellites);
  gps.noise = length(sensor, "noise", 0.0, 0.0, 1e6);
  gps.altitude = whole(sensor, "altitude", 0, 0, 1) == 1;
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
