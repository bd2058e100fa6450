#include "world/stage/laser_entities.h"

#include <fmt/format.h>

#include <cmath>

#include "world/stage/entity_color.h"
#include "world/stage/model_shape.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMaxSamples = 1'000'000;
constexpr std::uint32_t kMaxTransducers = 1'000;
constexpr double kTransducerHeight = 0.02;  // [m] of a 4.x sensor without a size, and of every 3.x transducer
constexpr double kMaxSeconds = 1e6;

double seconds(const StageContext& context, const Entity& entity, std::string_view key, double fallback) {
  const double value = number(context, entity, key, fallback);
  if (value >= 0.0 && value <= kMaxSeconds) return value;
  fail(context, find(entity, key)->at, fmt::format("'{}' is {} s; expected 0 to {} s", key, value, kMaxSeconds));
}

double rate_of(const StageContext& context, const Entity& entity, double fallback) {
  for (const char* key : {"rate", "update_interval"}) {
    const Property* property = find(entity, key);
    if (property == nullptr) continue;
    const bool is_rate = std::string_view(key) == "rate";
    const double value = number(context, entity, key, 0.0);
    if (value > 1e-6 && value <= 1e6) return is_rate ? value : 1000.0 / value;
    fail(context, property->at,
         fmt::format("'{}' is {}; expected {} above zero", key, value, is_rate ? "Hz" : "milliseconds"));
  }
  return fallback;
}

// LaserNoise holds standard deviations; Stage uses the first number as a variance.
LaserNoise noise_of(const StageContext& context, const LoadOptions& options, const Entity& entity,
                    const LaserNoise& fallback) {
  const auto values = tuple(context, entity, "noise", 3, "[constant proportional angular]");
  if (!values) return fallback;
  const SourceLocation at = find(entity, "noise")->at;
  const auto& v = *values;
  if (v[0] < 0.0 || v[1] < 0.0 || v[2] < 0.0) fail(context, at, "'noise' expects numbers that are not negative");
  LaserNoise noise;
  noise.range_sigma = to_metres(context, at, options.stage_noise ? std::sqrt(v[0] / context.metres_per_unit) : v[0]);
  noise.range_proportional = v[1];
  noise.angle_sigma = context.radians_per_unit * v[2];
  if (!(noise.range_proportional <= 1e3) || !(noise.angle_sigma <= 2 * M_PI)) {
    fail(context, at, "'noise' is out of range; expected [metres, metres per metre, angle]");
  }
  return noise;
}

/// Reads properties that a model sets for all of its transducers and that each transducer may override.
void read_common(const StageContext& context, const LoadOptions& options, const Entity& entity, Laser& laser) {
  laser.resolution = whole(context, entity, "laser_sample_skip", laser.resolution, 1, kMaxSamples);
  laser.resolution = whole(context, entity, "resolution", laser.resolution, 1, kMaxSamples);
  laser.rate = rate_of(context, entity, laser.rate);
  laser.phase = seconds(context, entity, "phase", laser.phase);
  laser.latency = seconds(context, entity, "latency", laser.latency);
  laser.noise = noise_of(context, options, entity, laser.noise);
  laser.accuracy = accuracy(context, options, entity, laser.accuracy);
}

void check_range(const StageContext& context, SourceLocation at, const Laser& laser) {
  if (!(laser.range_max > 0.0))
    fail(context, at, fmt::format("a largest range of {} m; expected more than 0", laser.range_max));
  if (laser.range_min >= 0.0 && laser.range_min <= laser.range_max) return;
  fail(context, at,
       fmt::format("a smallest range of {} m; expected 0 to the largest, {} m", laser.range_min, laser.range_max));
}

double check_fov(const StageContext& context, SourceLocation at, double fov) {
  constexpr double kTurn = 2.0 * M_PI;
  if (!(fov >= 0.0 && fov <= kTurn * (1.0 + 1e-12))) {
    fail(context, at, fmt::format("a field of view of {:.6g} degrees; expected 0 to 360", fov * 180.0 / M_PI));
  }
  return std::min(fov, kTurn);
}

void set_view(const StageContext& context, const Entity& entity, std::string_view key, Laser& laser) {
  const auto view = tuple(context, entity, key, 3, "[min max fov]");
  if (!view) return;
  const SourceLocation at = find(entity, key)->at;
  laser.range_min = to_metres(context, at, (*view)[0]);
  laser.range_max = to_metres(context, at, (*view)[1]);
  laser.fov = context.radians_per_unit * (*view)[2];
}

// --- 3.x: laser( samples fov range_min range_max resolution laser_color )
// -----------------------------------------------

Laser read_laser(StageContext& context, const LoadOptions& options, const Entity& entity, const Pose& X_MB,
                 double height) {
  Laser laser;
  read_common(context, options, entity, laser);
  laser.X_MS = compose(X_MB, {0.0, 0.0, height / 2.0, 0.0});
  laser.samples = whole(context, entity, "samples", 180, 1, kMaxSamples);
  laser.fov = check_fov(context, location_of(entity, "fov"), angle(context, entity, "fov", M_PI));
  laser.range_min = length(context, entity, "range_min", 0.0);
  laser.range_max = length(context, entity, "range_max", 8.0);
  check_range(context, location_of(entity, find(entity, "range_max") != nullptr ? "range_max" : "range_min"), laser);
  laser.color = entity_color(context, entity, "laser_color", laser.color, 0);
  return laser;
}

// --- 4.x: ranger( sensor( range fov samples pose size noise ) ... )
// -----------------------------------------------------

Laser read_sensor(StageContext& context, const LoadOptions& options, const Entity& entity, const Pose& X_MB,
                  Laser laser) {
  read_common(context, options, entity, laser);
  laser.samples = whole(context, entity, "samples", 1, 1, kMaxSamples);
  laser.range_min = 0.0;
  laser.range_max = 5.0;
  laser.fov = 0.1;
  set_view(context, entity, "view", laser);
  if (const auto range = tuple(context, entity, "range", 2, "[min max]")) {
    const SourceLocation at = find(entity, "range")->at;
    laser.range_min = to_metres(context, at, (*range)[0]);
    laser.range_max = to_metres(context, at, (*range)[1]);
  }
  const std::string_view view_or_range = find(entity, "range") != nullptr ? "range" : "view";
  check_range(context, location_of(entity, view_or_range), laser);
  laser.fov = check_fov(context, location_of(entity, find(entity, "fov") ? "fov" : "view"),
                        angle(context, entity, "fov", laser.fov));

  Pose X_BS = pose(context, entity, "pose");
  X_BS.z += size_of(context, entity, {kTransducerHeight, kTransducerHeight, kTransducerHeight}).z / 2.0;
  laser.X_MS = compose(X_MB, X_BS);
  laser.color = entity_color(context, entity, "color", laser.color, 0);
  return laser;
}

// --- 3.x: ranger( scount n sview [min max fov] spose[i] [x y yaw] )
// -----------------------------------------------------

Laser read_transducer(StageContext& context, const Entity& entity, const Pose& X_MB, std::uint32_t i, Laser laser) {
  Pose X_BS;
  if (find(entity, fmt::format("spose3[{}]", i)) != nullptr) {
    X_BS = pose(context, entity, fmt::format("spose3[{}]", i));
  } else {
    const std::string key = fmt::format("spose[{}]", i);
    const auto p = tuple(context, entity, key, 3, "[x y yaw]");
    if (!p) fail(context, location_of(entity, "scount"), fmt::format("'{}' is missing: 'scount' promises it", key));
    const SourceLocation at = find(entity, key)->at;
    X_BS = {to_metres(context, at, (*p)[0]), to_metres(context, at, (*p)[1]), 0.0, context.radians_per_unit * (*p)[2]};
    if (!(std::abs(X_BS.yaw) <= 1e6)) fail(context, at, fmt::format("the yaw of '{}' is out of range", key));
  }
  X_BS.z += kTransducerHeight / 2.0;
  laser.X_MS = compose(X_MB, X_BS);
  return laser;
}

std::vector<Laser> read_array(StageContext& context, const Entity& entity, const Pose& X_MB, Laser laser) {
  const std::uint32_t count = whole(context, entity, "scount", 0, 1, kMaxTransducers);
  laser.samples = 1;
  laser.range_min = 0.0;
  laser.range_max = 5.0;
  laser.fov = M_PI / count;
  set_view(context, entity, "sview", laser);
  check_range(context, location_of(entity, "sview"), laser);
  laser.fov = check_fov(context, location_of(entity, "sview"), laser.fov);
  std::vector<Laser> lasers;
  for (std::uint32_t i = 0; i < count; ++i) lasers.push_back(read_transducer(context, entity, X_MB, i, laser));
  return lasers;
}

}  // namespace

std::vector<Laser> lasers_of(StageContext& context, const LoadOptions& options, const Entity& entity, const Pose& X_MB,
                             double height, const std::string& name) {
  std::vector<Laser> lasers;
  if (entity.type == "laser") {
    lasers.push_back(read_laser(context, options, entity, X_MB, height));
  } else {
    Laser common;
    read_common(context, options, entity, common);
    if (find(entity, "scount") != nullptr) lasers = read_array(context, entity, X_MB, common);
    for (const Entity& child : entity.children) {
      if (child.type == "sensor") lasers.push_back(read_sensor(context, options, child, X_MB, common));
    }
    if (lasers.empty())
      warn(context, entity.at, fmt::format("'{}' measures nothing: no sensor( ) and no scount in it", entity.word));
  }
  for (std::size_t i = 0; i < lasers.size(); ++i)
    lasers[i].name = lasers.size() > 1 ? fmt::format("{}[{}]", name, i) : name;
  return lasers;
}

}  // namespace sf::world
