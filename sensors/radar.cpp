#include "sensors/radar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>
#include <vector>

#include "base/elementary.h"
#include "base/random.h"
#include "robots/kinematics.h"
#include "sensors/lidar_layout.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"
#include "sensors/spatial_scans.h"

namespace sf::sensors {

namespace {

constexpr std::uint32_t kNoiseId = 1u << 30;  ///< added to the numbers of radars, in the random numbers of lidars
constexpr double kDegree = M_PI / 180.0;

constexpr std::uint32_t kStatic = 1u << 30;  ///< added to the rows of static models, in the numbers of targets

/// The hit of one beam. A target is numbered by its mover's row in one copy of the world, or by its static model's row
/// plus kStatic.
struct Echo {
  std::uint32_t target = 0;
  double range = 0.0;  ///< [m]
  std::size_t beam = 0;
  auto key() const { return std::tuple(target, range, beam); }
};

/// One row: range, bearing, closing speed, elevation.
struct Target {
  std::uint32_t number = 0;
  std::array<double, kRadarNumbers> row{};
  auto key() const { return std::pair(row[0], number); }
};

std::vector<SpatialScanner> scanners_of(const std::vector<RadarSettings>& radars) {
  std::vector<SpatialScanner> scanners;
  for (const RadarSettings& s : radars)
    scanners.push_back({.X_MS = s.X_MS, .range_max = s.range_max, .beams = s.beams});
  return scanners;
}

/// Returns the velocity [m/s] of the body's point at `p`, both in the world.
glm::dvec3 velocity_at(const base::Report& state, const glm::dvec3& p) {
  const robots::WorldVelocity velocity = robots::velocity_on_slope(state);
  const glm::dvec3 arm = p - glm::dvec3{state.X_WM.x, state.X_WM.y, state.X_WM.z};
  return velocity.linear + glm::cross(velocity.angular, arm);
}

class Radars : public SpatialScans {
 public:
  Radars(const SensorContext& context, const ParsedSensors& sensors)
      : SpatialScans(context, radar_type, sensors, scanners_of(sensors.settings_as<RadarSettings>())),
        settings_(sensors.settings_as<RadarSettings>()),
        noise_(context.noise),
        copies_(context.world),
        scratch_(context.thread_pool.threads()) {}

  void collect(std::span<base::ReadingBlock> out) override {
    SpatialScans::collect(out);
    for (std::size_t i = 0; i < samples().size(); ++i) out[i].hits = {}, out[i].quality = {};  // of beams, not of rows
  }

 private:
  struct Scratch {
    std::vector<Echo> echoes;
    std::vector<Target> targets;
  };
  void finish(std::size_t sample, unsigned thread) override;
  void find_echoes(std::size_t sample, std::vector<Echo>& echoes);
  void find_targets(std::size_t sample, std::span<const Echo> echoes, std::vector<Target>& targets) const;
  void merge(const RadarSettings& s, std::vector<Target>& targets) const;
  void add_errors(const HostSample& sample, std::vector<Target>& targets) const;

  const std::vector<RadarSettings>& settings_;  ///< per row
  bool noise_;
  world::CopyIndex copies_;
  std::vector<Scratch> scratch_;  ///< per thread
};

void Radars::find_echoes(std::size_t i, std::vector<Echo>& echoes) {
  const RadarSettings& s = settings_[samples()[i].row];
  const scene::ScanOutput scan = output_of(i);
  echoes.clear();
  for (std::size_t k = 0; k < scan.ranges.size(); ++k) {
    if (scan.hits[k] >= world().models.size() || scan.ranges[k] < s.range_min) continue;
    const std::uint32_t mover = world().models[scan.hits[k]].mover;
    if (mover == world::kNone && !s.with_static) continue;
    echoes.push_back({mover != world::kNone ? mover : kStatic + scan.hits[k], scan.ranges[k], k});
  }
  std::ranges::sort(echoes, {}, &Echo::key);
}

/// @param echoes by target, each target's nearest first
void Radars::find_targets(std::size_t i, std::span<const Echo> echoes, std::vector<Target>& targets) const {
  const HostSample& sample = samples()[i];
  const std::uint32_t own = rows()[sample.row].mover;
  targets.clear();
  for (const Echo& echo : echoes) {
    if (!targets.empty() && targets.back().number == echo.target) continue;
    const glm::dvec3& d = settings_[sample.row].beams->directions[echo.beam];
    const glm::dvec3 along = X_WS(i).R * d, p = X_WS(i).p + echo.range * along;
    glm::dvec3 approach = velocity_at(states()[own], X_WS(i).p);
    if (echo.target < kStatic) approach -= velocity_at(states()[copies_.in_copy_of(own, echo.target)], p);
    const auto [bearing, elevation] = angles_of(d);
    targets.push_back({echo.target, {echo.range, bearing, glm::dot(approach, along), elevation}});
  }
  std::ranges::sort(targets, {}, &Target::key);
}

/// Leaves the nearest of targets that the radar cannot resolve.
void Radars::merge(const RadarSettings& s, std::vector<Target>& targets) const {
  std::size_t kept = 0;
  for (const Target& target : targets) {
    const auto is_same = [&](const Target& nearer) {
      return target.row[0] - nearer.row[0] < s.cell[0] &&
             std::abs(base::wrap_angle(target.row[1] - nearer.row[1])) < s.cell[1] &&
             std::abs(target.row[2] - nearer.row[2]) < s.cell[2];
    };
    if (std::none_of(targets.begin(), targets.begin() + static_cast<std::ptrdiff_t>(kept), is_same))
      targets[kept++] = target;
  }
  targets.resize(kept);
}

void Radars::add_errors(const HostSample& sample, std::vector<Target>& targets) const {
  const RadarSettings& s = settings_[sample.row];
  const SensorSpec& spec = rows()[sample.row];
  const auto key = [&](base::RandomStream stream) {
    return episodes().key(stream, spec.mover, kNoiseId + spec.sensor, sample.sequence);
  };
  const base::RandomKey error = key(base::RandomStream::spatial_range),
                        missed = key(base::RandomStream::spatial_dropout);
  if (noise_ && s.detection_range > 0.0)
    std::erase_if(targets, [&](const Target& t) {
      return base::random_uniform(missed, t.number)[0] >= detection_probability(t.row[0], s.detection_range);
    });
  for (Target& t : targets) {
    for (std::uint32_t k = 0; k < kRadarNumbers; ++k) {
      if (noise_ && s.noise[k] > 0.0) t.row[k] += s.noise[k] * base::random_normal(error, 2 * t.number + k / 2)[k % 2];
      if (s.step[k] > 0.0) t.row[k] = s.step[k] * std::round(t.row[k] / s.step[k]) + 0.0;
    }
    t.row[0] = std::max(0.0, t.row[0]);
    t.row[1] = base::wrap_angle(t.row[1]);
  }
  std::ranges::sort(targets, {}, &Target::key);
}

void Radars::finish(std::size_t i, unsigned thread) {
  auto& [echoes, targets] = scratch_[thread];
  const HostSample& sample = samples()[i];
  find_echoes(i, echoes);
  find_targets(i, echoes, targets);
  if (settings_[sample.row].cell[0] > 0.0) merge(settings_[sample.row], targets);
  add_errors(sample, targets);
  std::ranges::fill(sample.values, std::nan(""));
  for (std::size_t k = 0; k < std::min<std::size_t>(targets.size(), rows()[sample.row].elements); ++k)
    std::ranges::copy(targets[k].row, sample.values.subspan(kRadarNumbers * k).begin());
}

// --- Settings ---

/// Reads numbers in the order of the columns, in SI. @param meaning as of `tuple`
std::array<double, kRadarNumbers> read_row(const world::Sensor& sensor, std::string_view key, std::size_t least,
                                           const std::string& meaning) {
  std::array<double, kRadarNumbers> row{};
  const double units[] = {sensor.metres_per_unit, sensor.radians_per_unit, sensor.metres_per_unit,
                          sensor.radians_per_unit};
  const auto values = tuple(sensor, key, least, meaning);
  if (!values) return row;
  for (std::size_t k = 0; k < values->size(); ++k) {
    row[k] = units[k] * (*values)[k];
    if (!(row[k] >= 0.0 && row[k] <= 1e6))
      refuse(sensor, key, fmt::format("'{}' has {:g}; expected numbers from 0 to 1e6", key, (*values)[k]));
  }
  return row;
}

LidarLayout read_layout(const world::Sensor& sensor) {
  LidarLayout layout;
  layout.fov = std::min(angle(sensor, "fov", 90.0 * kDegree, 1e-6, 2.0 * M_PI * (1.0 + 1e-12)), 2.0 * M_PI);
  const std::uint32_t spaced =
      static_cast<std::uint32_t>(std::lround(layout.fov / (0.5 * kDegree))) + (layout.fov < 2.0 * M_PI ? 1 : 0);
  layout.columns = whole(sensor, "columns", spaced, 1, kMostRadarBeams);
  const std::uint32_t channels = whole(sensor, "channels", 1, 1, kMostChannels);
  if (std::size_t{channels} * layout.columns > kMostRadarBeams)
    refuse(sensor, "columns",
           fmt::format("'channels' {} times 'columns' {} are {} beams; expected at most {}", channels, layout.columns,
                       std::size_t{channels} * layout.columns, kMostRadarBeams));
  if ((channels > 1) != (find(sensor, "fov_v") != nullptr))
    refuse(sensor, channels > 1 ? "channels" : "fov_v",
           "'channels' are spread over 'fov_v'; expected both, or neither");
  const double high = 0.5 * angle(sensor, "fov_v", 0.0, 0.0, M_PI);
  for (std::uint32_t i = 0; i < channels; ++i)
    layout.elevations.push_back(channels == 1 ? 0.0 : high * (2.0 * i / (channels - 1) - 1.0));
  layout.offsets.resize(channels);
  return layout;
}

}  // namespace

RadarSettings read_radar(const world::Sensor& sensor) {
  RadarSettings s{.X_MS = spatial_mount(sensor)};
  if (const auto range = tuple(sensor, "range", 2, "[min max]"))
    s.range_min = sensor.metres_per_unit * (*range)[0], s.range_max = sensor.metres_per_unit * (*range)[1];
  require_range(sensor, "range", "a range", s.range_min, s.range_max, kLongestLidarRange);
  s.with_static = whole(sensor, "static", 0, 0, 1) == 1;
  const std::string row = "[range bearing speed elevation]";
  s.noise = read_row(sensor, "noise", 1, row);
  s.step = read_row(sensor, "step", 1, row);
  s.cell = read_row(sensor, "resolution", 3, "[range bearing speed]");
  if (find(sensor, "resolution") != nullptr && std::min({s.cell[0], s.cell[1], s.cell[2]}) == 0.0)
    refuse(sensor, "resolution", "'resolution' has a 0, by which all targets are resolved; expected numbers above 0");
  s.detection_range = length(sensor, "detection_range", 0.0, 0.0, 1e6);
  return s;
}

namespace {

ParsedSensors parse_radars(const world::World& world) {
  std::map<std::vector<double>, std::shared_ptr<const LidarBeams>> known;
  BeamBudget budget(world, "radars", "'columns', 'channels',");
  return parse_each(world, radar_type, [&](const world::Sensor& sensor, SensorSpec& row) {
    RadarSettings s = read_radar(sensor);
    const LidarLayout layout = read_layout(sensor);
    auto& shared = known[layout.description()];
    if (!shared) shared = std::make_shared<LidarBeams>(beams_of(layout));
    s.beams = shared;
    budget.add(sensor, "columns", layout.beams());
    row.X_MS = planar_mount(s.X_MS);
    row.elements = whole(sensor, "targets", 32, 1, kMostTargets);
    row.reach = s.range_max;
    const bool noisy = std::ranges::any_of(s.noise, [](double sigma) { return sigma > 0.0; });
    row.sigma = noisy || s.detection_range > 0.0 ? HUGE_VAL : 0.0;
    return s;
  });
}

constexpr std::string_view kKeys[] = {"targets", "range",  "fov",   "columns", "channels",   "fov_v",
                                      "pose6",   "static", "noise", "step",    "resolution", "detection_range"};
constexpr Column kColumns[] = {{"range_m"}, {"bearing_rad"}, {"closing_m_s"}, {"elevation_rad"}};
constexpr PlainNumber kNumbers[] = {{1e-3, 0.0}, {1e-6}, {1e-4}, {1e-6}};
static_assert(kMostTargets * kRadarNumbers <= kMaxPlainWords);
constexpr PlainForm kForm{kRadar, "radar", kNumbers};

}  // namespace

double detection_probability(double range, double half) {
  constexpr double kFalseAlarms = 1e-6;
  const double logarithm = base::log(kFalseAlarms), signal_at_half = logarithm / base::log(0.5) - 1.0;
  const double ratio = half / range, signal = signal_at_half * (ratio * ratio) * (ratio * ratio);
  return base::exp(logarithm / (1.0 + signal));
}

constinit const SensorType radar_type = plain<kForm>({
    .word = {"radar", kKeys},
    .base_port = 17000,
    .list = "targets",
    .columns = kColumns,
    .parse = parse_radars,
    .make = make_backend<Radars>,
});

}  // namespace sf::sensors
