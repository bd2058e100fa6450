#include "world/lasers.h"

#include <fmt/format.h>

#include <cmath>

#include "world/paint.h"
#include "world/shape.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMostSamples = 1'000'000;
constexpr std::uint32_t kMostTransducers = 1'000;
constexpr double kTransducerHeight = 0.02;  // [m] of a 4.x sensor without a size, and of every 3.x transducer
constexpr double kMostSeconds = 1e6;

double seconds(const Source& source, const Entity& entity, std::string_view key, double fallback) {
  const double value = number(source, entity, key, fallback);
  if (value >= 0.0 && value <= kMostSeconds) return value;
  fail(source, find(entity, key)->at, fmt::format("'{}' is {} s; expected 0 to {} s", key, value, kMostSeconds));
}

double rate_of(const Source& source, const Entity& entity, double fallback) {
  for (const char* key : {"rate", "update_interval"}) {
    const Property* property = find(entity, key);
    if (property == nullptr) continue;
    const bool is_rate = std::string_view(key) == "rate";
    const double value = number(source, entity, key, 0.0);
    if (value > 1e-6 && value <= 1e6) return is_rate ? value : 1000.0 / value;
    fail(source, property->at,
         fmt::format("'{}' is {}; expected {} above zero", key, value, is_rate ? "Hz" : "milliseconds"));
  }
  return fallback;
}

// Our contract is a standard deviation; Stage passes the first number on as a variance.
LaserNoise noise_of(const Source& source, const LoadOptions& options, const Entity& entity,
                    const LaserNoise& fallback) {
  const auto values = tuple(source, entity, "noise", 3, "[constant proportional angular]");
  if (!values) return fallback;
  const Place at = find(entity, "noise")->at;
  const auto& v = *values;
  if (v[0] < 0.0 || v[1] < 0.0 || v[2] < 0.0) fail(source, at, "'noise' expects numbers that are not negative");
  LaserNoise noise;
  noise.range_sigma = metres(source, at, options.stage_noise ? std::sqrt(v[0] / source.metres) : v[0]);
  noise.range_proportional = v[1];
  noise.angle_sigma = source.radians * v[2];
  if (!(noise.range_proportional <= 1e3) || !(noise.angle_sigma <= 2 * M_PI)) {
    fail(source, at, "'noise' is out of reach; expected [metres, metres per metre, angle]");
  }
  return noise;
}

/// What a model says once for all of its transducers, and a transducer may say again.
void read_common(const Source& source, const LoadOptions& options, const Entity& entity, Laser& laser) {
  laser.resolution = whole(source, entity, "laser_sample_skip", laser.resolution, 1, kMostSamples);
  laser.resolution = whole(source, entity, "resolution", laser.resolution, 1, kMostSamples);
  laser.rate = rate_of(source, entity, laser.rate);
  laser.phase = seconds(source, entity, "phase", laser.phase);
  laser.latency = seconds(source, entity, "latency", laser.latency);
  laser.noise = noise_of(source, options, entity, laser.noise);
  laser.accuracy = accuracy(source, options, entity, laser.accuracy);
}

void check_range(const Source& source, Place at, const Laser& laser) {
  if (!(laser.range_max > 0.0))
    fail(source, at, fmt::format("a largest range of {} m; expected more than 0", laser.range_max));
  if (laser.range_min >= 0.0 && laser.range_min <= laser.range_max) return;
  fail(source, at,
       fmt::format("a smallest range of {} m; expected 0 to the largest, {} m", laser.range_min, laser.range_max));
}

double check_fov(const Source& source, Place at, double fov) {
  constexpr double kTurn = 2.0 * M_PI;
  if (!(fov >= 0.0 && fov <= kTurn * (1.0 + 1e-12))) {
    fail(source, at, fmt::format("a field of view of {:.6g} degrees; expected 0 to 360", fov * 180.0 / M_PI));
  }
  return std::min(fov, kTurn);
}

void set_view(const Source& source, const Entity& entity, std::string_view key, Laser& laser) {
  const auto view = tuple(source, entity, key, 3, "[min max fov]");
  if (!view) return;
  const Place at = find(entity, key)->at;
  laser.range_min = metres(source, at, (*view)[0]);
  laser.range_max = metres(source, at, (*view)[1]);
  laser.fov = source.radians * (*view)[2];
}

// --- 3.x: laser( samples fov range_min range_max resolution laser_color )
// -----------------------------------------------

Laser read_laser(Source& source, const LoadOptions& options, const Entity& entity, const Pose& X_MB, double height) {
  Laser laser;
  read_common(source, options, entity, laser);
  laser.X_MS = compose(X_MB, {0.0, 0.0, height / 2.0, 0.0});
  laser.samples = whole(source, entity, "samples", 180, 1, kMostSamples);
  laser.fov = check_fov(source, place_of(entity, "fov"), angle(source, entity, "fov", M_PI));
  laser.range_min = length(source, entity, "range_min", 0.0);
  laser.range_max = length(source, entity, "range_max", 8.0);
  check_range(source, place_of(entity, find(entity, "range_max") != nullptr ? "range_max" : "range_min"), laser);
  laser.color = paint(source, entity, "laser_color", laser.color, 0);
  return laser;
}

// --- 4.x: ranger( sensor( range fov samples pose size noise ) ... )
// -----------------------------------------------------

Laser read_sensor(Source& source, const LoadOptions& options, const Entity& entity, const Pose& X_MB, Laser laser) {
  read_common(source, options, entity, laser);
  laser.samples = whole(source, entity, "samples", 1, 1, kMostSamples);
  laser.range_min = 0.0;
  laser.range_max = 5.0;
  laser.fov = 0.1;
  set_view(source, entity, "view", laser);
  if (const auto range = tuple(source, entity, "range", 2, "[min max]")) {
    const Place at = find(entity, "range")->at;
    laser.range_min = metres(source, at, (*range)[0]);
    laser.range_max = metres(source, at, (*range)[1]);
  }
  const std::string_view view_or_range = find(entity, "range") != nullptr ? "range" : "view";
  check_range(source, place_of(entity, view_or_range), laser);
  laser.fov = check_fov(source, place_of(entity, find(entity, "fov") ? "fov" : "view"),
                        angle(source, entity, "fov", laser.fov));

  Pose X_BS = pose(source, entity, "pose");
  X_BS.z += size_of(source, entity, {kTransducerHeight, kTransducerHeight, kTransducerHeight}).z / 2.0;
  laser.X_MS = compose(X_MB, X_BS);
  laser.color = paint(source, entity, "color", laser.color, 0);
  return laser;
}

// --- 3.x: ranger( scount n sview [min max fov] spose[i] [x y yaw] )
// -----------------------------------------------------

Laser read_transducer(Source& source, const Entity& entity, const Pose& X_MB, std::uint32_t i, Laser laser) {
  Pose X_BS;
  if (find(entity, fmt::format("spose3[{}]", i)) != nullptr) {
    X_BS = pose(source, entity, fmt::format("spose3[{}]", i));
  } else {
    const std::string key = fmt::format("spose[{}]", i);
    const auto p = tuple(source, entity, key, 3, "[x y yaw]");
    if (!p) fail(source, place_of(entity, "scount"), fmt::format("'{}' is missing: 'scount' promises it", key));
    const Place at = find(entity, key)->at;
    X_BS = {metres(source, at, (*p)[0]), metres(source, at, (*p)[1]), 0.0, source.radians * (*p)[2]};
    if (!(std::abs(X_BS.yaw) <= 1e6)) fail(source, at, fmt::format("the yaw of '{}' is out of reach", key));
  }
  X_BS.z += kTransducerHeight / 2.0;
  laser.X_MS = compose(X_MB, X_BS);
  return laser;
}

std::vector<Laser> read_array(Source& source, const Entity& entity, const Pose& X_MB, Laser laser) {
  const std::uint32_t count = whole(source, entity, "scount", 0, 1, kMostTransducers);
  laser.samples = 1;
  laser.range_min = 0.0;
  laser.range_max = 5.0;
  laser.fov = M_PI / count;
  set_view(source, entity, "sview", laser);
  check_range(source, place_of(entity, "sview"), laser);
  laser.fov = check_fov(source, place_of(entity, "sview"), laser.fov);
  std::vector<Laser> lasers;
  for (std::uint32_t i = 0; i < count; ++i) lasers.push_back(read_transducer(source, entity, X_MB, i, laser));
  return lasers;
}

}  // namespace

std::vector<Laser> lasers_of(Source& source, const LoadOptions& options, const Entity& entity, const Pose& X_MB,
                             double height, const std::string& name) {
  std::vector<Laser> lasers;
  if (entity.type == "laser") {
    lasers.push_back(read_laser(source, options, entity, X_MB, height));
  } else {
    Laser common;
    read_common(source, options, entity, common);
    if (find(entity, "scount") != nullptr) lasers = read_array(source, entity, X_MB, common);
    for (const Entity& child : entity.children) {
      if (child.type == "sensor") lasers.push_back(read_sensor(source, options, child, X_MB, common));
    }
    if (lasers.empty())
      warn(source, entity.at, fmt::format("'{}' measures nothing: no sensor( ) and no scount in it", entity.word));
  }
  for (std::size_t i = 0; i < lasers.size(); ++i)
    lasers[i].name = lasers.size() > 1 ? fmt::format("{}[{}]", name, i) : name;
  return lasers;
}

}  // namespace sf::world
