#include "sensors/ptz.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensors/host_backend.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kTurn = 2.0 * M_PI;
constexpr double kMostHold = 1e6;  // [s]
constexpr const char* kAxes[] = {"pan", "tilt", "fov"};
constexpr const char* kSpeeds[] = {"pan_speed", "tilt_speed", "zoom_speed"};

class PtzMounts : public HostBackend {
 public:
  PtzMounts(const SensorContext& context, const ParsedSensors& sensors)
      : HostBackend(context, ptz_type, sensors), settings_(sensors.settings_as<Ptz>()) {}

  void accumulate(std::int64_t now, bool /*between*/) override { now_ = now; }

 private:
  void measure(std::span<const HostSample> samples) const override {
    for (const HostSample& sample : samples)
      std::ranges::copy(position_of(settings_[sample.row], time_of(sample.row)), sample.values.begin());
  }

  /// [s] of the mover's clock
  double time_of(std::uint32_t row) const {
    return 1e-9 * static_cast<double>(now_ - episodes().start_of(rows()[row].mover));
  }

  const std::vector<Ptz>& settings_;  ///< per row
  std::int64_t now_ = 0;              ///< [ns]
};

double time_between(const Ptz& mount, const PtzAxes& from, const PtzAxes& to) {
  double seconds = 0.0;
  for (std::size_t k = 0; k < 3; ++k) seconds = std::max(seconds, std::abs(to[k] - from[k]) / mount.speed[k]);
  return seconds;
}

/// [rad] Limits of an axis.
std::array<double, 2> read_limits(const world::Sensor& sensor, std::size_t axis, std::array<double, 2> fallback,
                                  double least, double most) {
  const auto v = tuple(sensor, kAxes[axis], 2, "[min max]");
  if (!v) return fallback;
  const std::array<double, 2> limits{sensor.radians_per_unit * (*v)[0], sensor.radians_per_unit * (*v)[1]};
  if (limits[0] >= least && limits[0] <= limits[1] && limits[1] <= most) return limits;
  refuse(sensor, kAxes[axis],
         fmt::format("'{}' is [{:g} {:g}]; expected [min max] from {:.4g} to {:.4g}", kAxes[axis], (*v)[0], (*v)[1],
                     least / sensor.radians_per_unit, most / sensor.radians_per_unit));
}

ParsedSensors parse_mounts(const world::World& world) {
  return parse_each(world, ptz_type, [](const world::Sensor& sensor, SensorSpec& row) {
    row.reach = 0.0;
    return read_ptz(sensor);
  });
}

constexpr std::string_view kKeys[] = {"pan", "tilt", "fov", "pan_speed", "tilt_speed", "zoom_speed", "views", "view[]"};
constexpr Column kColumns[] = {{"pan_rad"}, {"tilt_rad"}, {"fov_rad"}};
constexpr PlainNumber kNumbers[] = {{1e-6}, {1e-6}, {1e-6, 0.0}};
constexpr PlainForm kForm{kPtz, "ptz", kNumbers};

}  // namespace

PtzAxes position_of(const Ptz& mount, double time) {
  const auto& views = mount.views;
  const auto next = [&](std::size_t i) -> const PtzView& { return views[(i + 1) % views.size()]; };
  double cycle = 0.0;
  for (std::size_t i = 0; i < views.size(); ++i)
    cycle += views[i].hold + time_between(mount, views[i].axes, next(i).axes);
  if (!(cycle > 0.0)) return views[0].axes;
  double left = std::fmod(time, cycle);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (left <= views[i].hold) return views[i].axes;
    left -= views[i].hold;
    const double moving = time_between(mount, views[i].axes, next(i).axes);
    if (left < moving) {
      PtzAxes at = views[i].axes;
      for (std::size_t k = 0; k < 3; ++k) at[k] += left / moving * (next(i).axes[k] - at[k]);
      return at;
    }
    left -= moving;
  }
  return views[0].axes;
}

Ptz read_ptz(const world::Sensor& sensor) {
  constexpr double kDegree = M_PI / 180.0;
  const std::array<std::array<double, 2>, 3> limits{
      read_limits(sensor, 0, {-100.0 * kDegree, 100.0 * kDegree}, -kTurn, kTurn),
      read_limits(sensor, 1, {-30.0 * kDegree, 90.0 * kDegree}, -kTurn / 4, kTurn / 4),
      read_limits(sensor, 2, {3.0 * kDegree, 47.5 * kDegree}, 1e-4, kTurn / 2)};
  Ptz mount;
  const double speeds[] = {90.0 * kDegree, 70.0 * kDegree, 20.0 * kDegree};
  for (std::size_t k = 0; k < 3; ++k) mount.speed[k] = angle(sensor, kSpeeds[k], speeds[k], 1e-6, 1e6);
  const std::uint32_t count = whole(sensor, "views", 0, 1, kMostPtzViews);
  refuse_beyond(sensor, "view[", "views", count, kMostPtzViews);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string key = fmt::format("view[{}]", i);
    const auto v = tuple(sensor, key, 4, "[pan tilt fov seconds]");
    if (!v) refuse(sensor, "views", fmt::format("'{}' is missing: 'views' is {}", key, count));
    PtzView& view = mount.views.emplace_back(PtzView{{}, (*v)[3]});
    for (std::size_t k = 0; k < 3; ++k) {
      view.axes[k] = sensor.radians_per_unit * (*v)[k];
      if (!(view.axes[k] >= limits[k][0] && view.axes[k] <= limits[k][1]))
        refuse(sensor, key,
               fmt::format("'{}' has the {} {:g}; expected {:.4g} to {:.4g}", key, kAxes[k], (*v)[k],
                           limits[k][0] / sensor.radians_per_unit, limits[k][1] / sensor.radians_per_unit));
    }
    if (!(view.hold >= 0.0 && view.hold <= kMostHold))
      refuse(sensor, key, fmt::format("'{}' holds {:g} s; expected 0 to {:g}", key, view.hold, kMostHold));
  }
  if (count == 0)
    mount.views.push_back(
        {{std::clamp(0.0, limits[0][0], limits[0][1]), std::clamp(0.0, limits[1][0], limits[1][1]), limits[2][1]},
         0.0});
  return mount;
}

constinit const SensorType ptz_type = plain<kForm>({
    .word = {"ptz", kKeys},
    .base_port = 60000,
    .list = "",
    .columns = kColumns,
    .parse = parse_mounts,
    .make = make_backend<PtzMounts>,
});

}  // namespace sf::sensors
