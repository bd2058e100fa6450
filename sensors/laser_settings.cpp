#include "sensors/laser_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/tilted_pose.h"
#include "sensors/accuracy.h"
#include "sensors/elements.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::uint32_t kMostSamples = 1'000'000;
constexpr std::uint32_t kMostRollingBeams = 10'000;
constexpr std::uint32_t kMostTransducers = 1'000;
constexpr double kTransducerHeight = 0.02;  // [m]
constexpr double kLongestLaserRange = 1e7;  // [m]

/// Reads `[min max]` or `[min max fov]`.
void read_range(const world::Sensor& sensor, std::string_view key, std::size_t count, LaserSettings& laser) {
  const auto v = tuple(sensor, key, count, count == 3 ? "[min max fov]" : "[min max]");
  if (!v) return;
  laser.range_min = sensor.metres_per_unit * (*v)[0];
  laser.range_max = sensor.metres_per_unit * (*v)[1];
  if (count == 3) laser.fov = sensor.radians_per_unit * (*v)[2];
}

/// Returns the setting that an error names: the first of `keys` that the sensor has.
std::string_view present(const world::Sensor& sensor, std::initializer_list<std::string_view> keys) {
  const auto has = [&](std::string_view key) { return find(sensor, key) != nullptr; };
  const auto found = std::find_if(keys.begin(), keys.end(), has);
  return found == keys.end() ? std::string_view() : *found;
}

void check(const world::Sensor& sensor, LaserSettings& laser) {
  constexpr double kTurn = 2.0 * M_PI;
  const std::string_view range = present(sensor, {"range_max", "range_min", "range", "view", "sview"});
  if (!(laser.range_max > 0.0 && laser.range_max <= kLongestLaserRange))
    refuse(
        sensor, range,
        fmt::format("a largest range of {:g} m; expected more than 0, to {:g} m", laser.range_max, kLongestLaserRange));
  if (!(laser.range_min >= 0.0 && laser.range_min <= laser.range_max))
    refuse(
        sensor, range,
        fmt::format("a smallest range of {:g} m; expected 0 to the largest, {:g} m", laser.range_min, laser.range_max));
  if (!(laser.fov >= 0.0 && laser.fov <= kTurn * (1.0 + 1e-12)))
    refuse(sensor, present(sensor, {"fov", "view", "sview"}),
           fmt::format("a field of view of {:g} degrees; expected 0 to 360{}", laser.fov * 180.0 / M_PI,
                       hint_of_radians(sensor, laser.fov)));
  laser.fov = std::min(laser.fov, kTurn);
}

/// A level mount is computed as that of `pose`, whose bytes it has.
void read_mount(const world::Sensor& sensor, LaserSettings& laser) {
  const base::TiltedPose mount = base::tilted_pose_of(spatial_mount(sensor));
  const auto pose = tuple(sensor, "pose6", 6, "[x y z roll pitch yaw]");
  if (pose && ((*pose)[3] != 0.0 || (*pose)[4] != 0.0)) {
    laser.X_MS = mount.X, laser.tilt = mount.tilt;
    return;
  }
  laser.X_MS = sensor.X_MS;
  if (pose) {
    const double unit = sensor.metres_per_unit;
    laser.X_MS = base::compose(
        laser.X_MS, {unit * (*pose)[0], unit * (*pose)[1], unit * (*pose)[2], sensor.radians_per_unit * (*pose)[5]});
  }
  laser.X_MS.z += 0.5 * sensor.height;
}

/// @param laser defaults of samples, field of view and range, which depend on the form of the sensor
LaserSettings read_laser(const world::Sensor& sensor, LaserSettings laser) {
  const SensorSpec common = common_spec(sensor, 0, 0);
  laser.name = sensor.name;
  read_mount(sensor, laser);
  laser.samples = whole(sensor, "samples", laser.samples, 1, kMostSamples);
  read_range(sensor, "sview", 3, laser);
  read_range(sensor, "view", 3, laser);
  read_range(sensor, "range", 2, laser);
  laser.range_min = length(sensor, "range_min", laser.range_min, -HUGE_VAL, HUGE_VAL);
  laser.range_max = length(sensor, "range_max", laser.range_max, -HUGE_VAL, HUGE_VAL);
  laser.fov = angle(sensor, "fov", laser.fov, -HUGE_VAL, HUGE_VAL);
  check(sensor, laser);
  laser.resolution = whole(sensor, "laser_sample_skip", 1, 1, kMostSamples);
  laser.resolution = whole(sensor, "resolution", laser.resolution, 1, kMostSamples);
  laser.noise = scan_noise_of(sensor);
  laser.rate = common.rate;
  laser.phase = common.phase;
  laser.latency = common.latency;
  laser.priority = common.priority;
  const double turn_time = laser.fov / (2.0 * M_PI * laser.rate);
  if (whole(sensor, "rolling", 0, 0, 1) == 1)
    laser.scan_time = number(sensor, "scan_time", std::max(1e-6, turn_time), 1e-6, 60.0);
  else if (find(sensor, "scan_time") != nullptr)
    refuse(sensor, "scan_time", "'scan_time' is that of a rolling scan; expected 'rolling 1' with it");
  if (laser.scan_time > 0.0 && laser.samples > kMostRollingBeams)
    refuse(sensor, "rolling",
           fmt::format("a rolling scan of {} beams; expected at most {}", laser.samples, kMostRollingBeams));
  laser.accuracy = accuracy_of(sensor);
  laser.color = sensor.color;
  return laser;
}

void add_ranger(const world::Sensor& sensor, std::vector<LaserSettings>& lasers) {
  LaserSettings defaults;
  defaults.samples = 1;
  defaults.range_max = 5.0;
  defaults.fov = 0.1;
  if (find(sensor, "scount") == nullptr) {
    lasers.push_back(read_laser(sensor, defaults));
    return;
  }
  const std::vector<Pose> elements = read_elements(sensor, kMostTransducers);
  defaults.fov = M_PI / static_cast<double>(elements.size());
  LaserSettings laser = read_laser(sensor, defaults);
  for (Pose X_SE : elements) {
    X_SE.z += 0.5 * kTransducerHeight;
    laser.X_MS = base::compose(sensor.X_MS, X_SE);
    lasers.push_back(laser);
  }
}

/// Renames neighbours with the same name to name[0], name[1], ...
void number_equal_names(std::vector<LaserSettings>& lasers) {
  for (std::size_t first = 0, end; first < lasers.size(); first = end) {
    const std::string name = lasers[first].name;
    for (end = first + 1; end < lasers.size() && lasers[end].name == name; ++end) {
    }
    for (std::size_t i = first; i < end && end - first > 1; ++i)
      lasers[i].name = fmt::format("{}[{}]", name, i - first);
  }
}

}  // namespace

std::vector<LaserSettings> lasers_of(const world::Mover& mover) {
  std::vector<LaserSettings> lasers;
  for (const world::Sensor& sensor : mover.sensors) {
    if (sensor.type == kLaserWord.type) lasers.push_back(read_laser(sensor, {}));
    if (sensor.type == kRangerWord.type) add_ranger(sensor, lasers);
  }
  number_equal_names(lasers);
  return lasers;
}

void require_level(const world::World& world, const LaserSettings& laser, std::string_view use) {
  if (base::is_level(laser.tilt)) return;
  throw base::InputError(
      world.file, 0,
      fmt::format("laser '{}' is tilted by its 'pose6', but {} takes its scans to be level; expected "
                  "a roll and a pitch of 0, or another laser",
                  laser.name, use));
}

world::Sensor laser_sensor(const LaserSettings& laser) {
  world::Sensor sensor{.type = std::string(kLaserWord.type), .name = laser.name, .X_MS = laser.X_MS};
  sensor.color = laser.color;
  const auto set = [&](const char* key, std::vector<double> numbers) {
    sensor.settings.push_back({key, std::move(numbers), "", 0, ""});
  };
  set("samples", {static_cast<double>(laser.samples)});
  set("fov", {laser.fov});
  set("range_min", {laser.range_min});
  set("range_max", {laser.range_max});
  set("resolution", {static_cast<double>(laser.resolution)});
  set("noise", {laser.noise.range_sigma, laser.noise.range_proportional, laser.noise.angle_sigma});
  set("rate", {laser.rate});
  set("phase", {laser.phase});
  set("latency", {laser.latency});
  if (!base::is_level(laser.tilt)) set("pose6", {0.0, 0.0, 0.0, laser.tilt.roll, laser.tilt.pitch, 0.0});
  if (laser.scan_time > 0.0) set("rolling", {1.0}), set("scan_time", {laser.scan_time});
  const world::Accuracy& accuracy = laser.accuracy;
  if (!accuracy.word.empty()) sensor.settings.push_back({"accuracy", {}, accuracy.word, accuracy.line, accuracy.file});
  return sensor;
}

raycast::ScanNoise scan_noise_of(const world::Sensor& sensor) {
  const auto values = tuple(sensor, "noise", 3, "[constant proportional angular]");
  if (!values) return {};
  const auto& v = *values;
  if (!(v[0] >= 0.0 && v[1] >= 0.0 && v[2] >= 0.0))
    refuse(sensor, "noise", "'noise' expects numbers that are not negative");
  const raycast::ScanNoise noise{sensor.metres_per_unit * v[0], v[1], sensor.radians_per_unit * v[2]};
  if (!(noise.range_sigma <= kLongestLaserRange && noise.range_proportional <= 1e3 && noise.angle_sigma <= 2.0 * M_PI))
    refuse(sensor, "noise", "'noise' is out of range; expected [metres, metres per metre, angle]");
  return noise;
}

}  // namespace sf::sensors
