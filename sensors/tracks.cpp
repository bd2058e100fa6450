#include "sensors/tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/elementary.h"
#include "base/time.h"
#include "robots/estimation/object_tracks.h"
#include "sensors/derived/pose_history.h"
#include "sensors/features.h"
#include "sensors/plain_packets.h"
#include "sensors/pose_sensor.h"
#include "sensors/radar.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

using estimation::FeatureKind;
using estimation::ObjectTrack;
using estimation::Observation;

enum TrackPort : std::uint8_t { kFeatureInputs, kPoseInputs, kRadarInputs };
constexpr double kExtentShare = 0.5;      // standard deviation of an object's middle, as a share of its half width
constexpr double kDepthShare = 0.4;       // of the half width, from the ends of what is seen to the middle
constexpr double kLargestExtent = 0.5;    // [m] default
constexpr double kLongestContact = 60.0;  // [s]
constexpr std::int64_t kLatest = base::kSecond;
constexpr double kFarthestFeature = 1e6;  // [m]
// [s] over which the motion of a radar is a mean of stated poses, and the standard deviation [m/s] of its error
constexpr std::int64_t kOwnMotion = base::kSecond / 2;
constexpr double kOwnSpeedSigma = 0.15;
constexpr double kLeastRadarSigma = 1e-2;  // [m] of targets without noise
constexpr double kLeastLevel = 0.5;        // [-] cosine of a target's elevation

/// The rows of one reading of `features`, or of a radar, waiting for the pose at their time.
struct PendingFeatures {
  std::int64_t time = 0;  ///< [ns] of the measurement
  std::uint32_t input = 0;
  std::vector<double> values;
  auto key() const { return std::pair(time, input); }
};

/// Returns the covariance of a point at `p_WP` of a body at X_WM that is due to the error of X_WM.
estimation::Spread spread_by(const StatedPose& pose, glm::dvec2 p_WP) {
  const auto& [xx, xy, xt, yy, yt, tt] = pose.covariance;
  const double dx = p_WP.x - pose.X_WM.x, dy = p_WP.y - pose.X_WM.y;
  return {xx - 2.0 * dy * xt + dy * dy * tt, xy + dx * xt - dy * yt - dx * dy * tt, yy + 2.0 * dx * yt + dx * dx * tt};
}

/// Returns a covariance in the frame of a robot in that of the world.
estimation::Spread turned(double yaw, double xx, double xy, double yy) {
  const auto [s, c] = base::sin_cos(yaw);
  return {c * c * xx - 2.0 * c * s * xy + s * s * yy, c * s * (xx - yy) + (c * c - s * s) * xy,
          s * s * xx + 2.0 * c * s * xy + c * c * yy};
}

class TracksSensor final : public sensorfarm::DerivedSensor {
 public:
  TracksSensor(const DerivedContext& context, const estimation::TrackOptions& options, double radius, double extent)
      : robot_(context.site.sensor.robot), radius_(radius), extent_(extent), tracks_(options) {
    for (const sensorfarm::DerivedInput& input : context.site.inputs) add_input(input);
    for (std::uint32_t i = 0; i < context.inputs.size(); ++i)
      if (context.inputs[i].port == kRadarInputs)
        radars_.emplace(i, read_radar(input_settings(context.world, context.inputs[i])));
  }

  void add_input(const sensorfarm::DerivedInput& input) override { inputs_.push_back(input); }

  void take(std::uint32_t input, const sensorfarm::Reading& reading) override {
    if (inputs_[input].port == kPoseInputs)
      return poses_[inputs_[input].robot].take(reading, inputs_[input].sensor.columns);
    if (inputs_[input].port == kRadarInputs) {
      pending_.push_back({base::nanoseconds(reading.time), input, {reading.values.begin(), reading.values.end()}});
      return;
    }
    if (reading.values.size() < kFeatureNumbers) return;
    const double age = reading.values[kFeatureNumbers - 1];  // all rows have that of one measurement
    pending_.push_back({base::nanoseconds(reading.time - (std::isfinite(age) ? age : 0.0)),
                        input,
                        {reading.values.begin(), reading.values.end()}});
  }

  void read(double seconds, sensorfarm::DerivedReading out) override {
    const std::int64_t now = base::nanoseconds(seconds);
    std::ranges::sort(pending_, {}, &PendingFeatures::key);
    for (const PendingFeatures& features : pending_)
      if (now - features.time <= kLatest) add(features);
    pending_.clear();
    tracks_.end_old(now);
    write(tracks_.at(now), now, out);
  }

 private:
  void add(const PendingFeatures& features);
  void add_targets(const PendingFeatures& targets, const PoseHistory& poses, const StatedPose& pose);
  Observation observation_of(std::span<const double> row, const StatedPose& pose) const;
  void write(std::vector<ObjectTrack> objects, std::int64_t now, sensorfarm::DerivedReading& out);
  void decide(const ObjectTrack& object, std::int64_t now, double* ahead, double* contact) const;

  std::uint32_t robot_;  ///< row in its copy of the world, as of inputs
  double radius_, extent_;
  std::vector<sensorfarm::DerivedInput> inputs_;
  std::map<std::uint32_t, RadarSettings> radars_;  ///< by input
  std::map<std::uint32_t, PoseHistory> poses_;     ///< by robot
  std::vector<PendingFeatures> pending_;
  std::vector<Observation> observations_;
  estimation::ObjectTracks tracks_;
};

Observation TracksSensor::observation_of(std::span<const double> row, const StatedPose& pose) const {
  const auto kind = static_cast<FeatureKind>(static_cast<int>(row[kFeatureKindAt]));
  Observation seen{.p = base::transform(pose.X_WM, {row[0], row[1]}), .corner = kind == FeatureKind::corner};
  seen.own = turned(pose.X_WM.yaw, row[4], row[5], row[7]);
  seen.repeated = spread_by(pose, seen.p);
  // The middle of an object of known size is what is seen.
  if (kind == FeatureKind::cluster) {
    const double half_length = row[kFeatureKindAt + 1], distance = base::hypot(row[0], row[1]);
    const double extent = kExtentShare * (half_length > 0.0 ? half_length : extent_);
    seen.repeated[0] += extent * extent, seen.repeated[2] += extent * extent;
    const double behind = half_length > 0.0 ? kDepthShare * half_length : extent_;
    if (distance > 0.0) seen.to_middle = base::rotate(pose.X_WM.yaw, glm::dvec2{row[0], row[1]} * (behind / distance));
  }
  seen.tag =
      kind == FeatureKind::tag ? static_cast<std::uint32_t>(std::clamp(row[kFeatureKindAt + 2], 0.0, 65535.0)) : 0;
  return seen;
}

void TracksSensor::add(const PendingFeatures& features) {
  const auto known = poses_.find(inputs_[features.input].robot);
  const auto pose = known == poses_.end() ? std::nullopt : known->second.at(features.time);
  if (!pose) return;
  if (inputs_[features.input].port == kRadarInputs) return add_targets(features, known->second, *pose);
  observations_.clear();
  std::vector<estimation::SeenWall> walls;
  for (std::size_t at = 0; at + kFeatureNumbers <= features.values.size(); at += kFeatureNumbers) {
    const std::span<const double> row = std::span(features.values).subspan(at, kFeatureNumbers);
    const bool usable = row[3] != 0.0 && std::abs(row[0]) < kFarthestFeature && std::abs(row[1]) < kFarthestFeature &&
                        row[4] > 0.0 && row[7] > 0.0 && row[4] * row[7] > row[5] * row[5];
    if (!usable) continue;
    if (row[kFeatureKindAt] != static_cast<double>(FeatureKind::line)) {
      observations_.push_back(observation_of(row, *pose));
      continue;
    }
    const glm::dvec2 along = base::rotate(row[2], {1.0, 0.0}), n{-along.y, along.x};
    walls.push_back({base::transform(pose->X_WM, {row[0], row[1]}), base::rotate(pose->X_WM.yaw, along),
                     row[kFeatureKindAt + 1], n.x * n.x * row[4] + 2.0 * n.x * n.y * row[5] + n.y * n.y * row[7]});
  }
  tracks_.add_walls(features.time, walls);
  tracks_.add(features.time, observations_);
}

/// The motion of the radar, with which closing speeds become speeds of objects, is that of the poses before.
void TracksSensor::add_targets(const PendingFeatures& targets, const PoseHistory& poses, const StatedPose& pose) {
  const auto before = poses.at(targets.time - kOwnMotion);
  if (!before) return;
  const RadarSettings& radar = radars_.at(targets.input);
  const base::Pose X_RS = planar_mount(radar.X_MS);
  const glm::dvec2 p_WS = base::transform(pose.X_WM, {X_RS.x, X_RS.y});
  const glm::dvec2 v = (p_WS - base::transform(before->X_WM, {X_RS.x, X_RS.y})) / (1e-9 * kOwnMotion);
  observations_.clear();
  for (std::size_t at = 0; at + kRadarNumbers <= targets.values.size(); at += kRadarNumbers) {
    const double* const row = targets.values.data() + at;
    if (!std::isfinite(row[0] + row[1] + row[2] + row[3])) continue;
    const double level = base::cos(row[3]), range = row[0] * level, yaw = pose.X_WM.yaw + X_RS.yaw + row[1];
    const glm::dvec2 u = base::rotate(yaw, {1.0, 0.0});
    const double along = std::max(radar.noise[0], kLeastRadarSigma);
    const double across = range * radar.noise[1] + kLeastRadarSigma, side = kExtentShare * extent_;
    Observation seen{.p = p_WS + range * u, .to_middle = extent_ * u};
    seen.own = turned(yaw, along * along, 0.0, across * across);
    seen.repeated = spread_by(pose, seen.p);
    seen.repeated[0] += side * side, seen.repeated[2] += side * side;
    const double sigma = base::hypot(radar.noise[2], kOwnSpeedSigma);
    seen.radial = {u, glm::dot(v, u) - row[2] / std::max(level, kLeastLevel), sigma * sigma};
    observations_.push_back(seen);
  }
  tracks_.add(targets.time, observations_);
}

/// The distance of an object in the robot's corridor, and the time until it is within `radius_`.
void TracksSensor::decide(const ObjectTrack& object, std::int64_t now, double* ahead, double* contact) const {
  *ahead = *contact = NAN;
  const auto own = poses_.find(robot_);
  const auto pose = own == poses_.end() ? std::nullopt : own->second.at(now);
  if (!pose) return;
  const glm::dvec2 d = object.p - glm::dvec2{pose->X_WM.x, pose->X_WM.y};
  const glm::dvec2 p = base::rotate(-pose->X_WM.yaw, d);
  if (p.x > 0.0 && std::abs(p.y) <= radius_) *ahead = p.x;
  const glm::dvec2 v = (object.moving ? object.v : glm::dvec2{}) - own->second.velocity();
  // |d + v t| = radius
  const double a = glm::dot(v, v), b = glm::dot(d, v), c = glm::dot(d, d) - radius_ * radius_;
  if (c <= 0.0) {
    *contact = 0.0;
    return;
  }
  const double root = b * b - a * c;
  if (!(b < 0.0 && root >= 0.0)) return;
  const double t = c / (-b + std::sqrt(root));
  if (t <= kLongestContact) *contact = t;
}

void TracksSensor::write(std::vector<ObjectTrack> objects, std::int64_t now, sensorfarm::DerivedReading& out) {
  const std::size_t rows = out.valid.size();
  std::ranges::fill(out.valid, std::uint8_t{0});
  if (objects.size() > rows) {
    const auto own = poses_.find(robot_);
    const auto pose = own == poses_.end() ? std::nullopt : own->second.at(now);
    const glm::dvec2 from = pose ? glm::dvec2{pose->X_WM.x, pose->X_WM.y} : glm::dvec2{};
    const auto rank = [&](const ObjectTrack& o) { return std::pair(!o.moving, pose ? glm::length(o.p - from) : 0.0); };
    std::ranges::stable_sort(objects, {}, rank);
    objects.resize(rows);
    std::ranges::sort(objects, {}, &ObjectTrack::identity);
  }
  constexpr std::size_t kNumbersOfRow = kTrackNumbers - 11;  // without `valid` and the covariance
  for (std::size_t row = 0; row < rows; ++row) {
    double* to = out.values.data() + kNumbersOfRow * row;
    to[7] = to[8] = NAN;
    if (row >= objects.size()) continue;
    const ObjectTrack& object = objects[row];
    to[0] = object.p.x, to[1] = object.p.y, to[2] = object.v.x, to[3] = object.v.y;
    to[4] = object.identity, to[5] = object.corner ? 3.0 : object.moving ? 2.0 : 1.0, to[6] = object.tag;
    decide(object, now, to + 7, to + 8);
    double* covariance = out.covariance.data() + triangle(4) * row;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i; j < 4; ++j) *covariance++ = object.covariance(i, j);
    out.valid[row] = 1;
  }
}

/// @throws base::InputError unless each robot with features has one pose
void check_poses(const DerivedContext& context) {
  std::map<std::uint32_t, int> features, poses;
  for (const WiredInput& input : context.inputs) ++(input.port == kPoseInputs ? poses : features)[input.mover];
  for (const auto& [mover, count] : features)
    if (poses[mover] != 1)
      refuse(context.settings, "inputs",
             fmt::format(
                 "features and radars of '{0}' need one pose of '{0}', such as \"{0}/localization\"; there are {1}",
                 context.world.movers[mover].name, poses[mover]));
  for (const auto& [mover, count] : poses)
    if (count > 1)
      refuse(context.settings, "inputs",
             fmt::format("there are {} poses of '{}'; expected one", count, context.world.movers[mover].name));
}

std::unique_ptr<sensorfarm::DerivedSensor> make_tracks(const DerivedContext& context) {
  if (std::ranges::all_of(context.inputs, [](const WiredInput& input) { return input.port == kPoseInputs; }))
    refuse(context.settings, "inputs", "tracks need features or a radar among their inputs");
  check_poses(context);
  const world::Sensor& s = context.settings;
  estimation::TrackOptions options;
  options.keep = number(s, "keep", options.keep, 0.01, 3600.0);
  options.agility = length(s, "agility", options.agility, 1e-3, 1e3);
  options.speed = length(s, "speed", options.speed, 1e-3, 1e3);
  const double own = std::clamp(context.world.movers[context.spec.mover].radius, 1e-3, 1e3);
  return std::make_unique<TracksSensor>(context, options, length(s, "radius", own, 1e-3, 1e3),
                                        length(s, "extent", std::min(own, kLargestExtent), 0.0, 1e3));
}

constexpr std::string_view kRadarColumns[] = {"range_m", "bearing_rad", "closing_m_s", "elevation_rad"};
constexpr DerivedPort kPorts[] = {
    {"features", kFeatureColumns, 0, 4096}, {"pose", kPoseColumns, 1, 4096}, {"radar", kRadarColumns, 0, 4096}};
constexpr DerivedForm kDerived{.ports = kPorts, .quantities = 4, .covariance = true, .extra = 5, .make = make_tracks};

constexpr std::string_view kKeys[] = {kDerivedKeys[0], kDerivedKeys[1], "most",   "keep",
                                      "agility",       "speed",         "radius", "extent"};
constexpr Column kColumns[] = {{"x_m"},
                               {"y_m"},
                               {"vx_m_s"},
                               {"vy_m_s"},
                               {"valid", 1, true},
                               {"xx_m2"},
                               {"xy_m2"},
                               {"x_vx_m2_s"},
                               {"x_vy_m2_s"},
                               {"yy_m2"},
                               {"y_vx_m2_s"},
                               {"y_vy_m2_s"},
                               {"vx_vx_m2_s2"},
                               {"vx_vy_m2_s2"},
                               {"vy_vy_m2_s2"},
                               {"identity", 1, true},
                               {"kind", 1, true},
                               {"tag", 1, true},
                               {"ahead_m"},
                               {"contact_s"}};
constexpr PlainNumber kNumbers[] = {{5e-3},          {5e-3},
                                    kReal,           kReal,
                                    {1.0, 0.0, 1.0}, kReal,
                                    kReal,           kReal,
                                    kReal,           kReal,
                                    kReal,           kReal,
                                    kReal,           kReal,
                                    kReal,           {1.0, 0.0, 2147483647.0},
                                    {1.0, 0.0, 3.0}, {1.0, 0.0, 65535.0},
                                    kReal,           kReal};
static_assert(std::size(kColumns) == kTrackNumbers && std::size(kNumbers) == kTrackNumbers);
static_assert(kMostObjects * kTrackNumbers <= kMaxPlainWords);
constexpr PlainForm kForm{kTracks, "tracks", kNumbers};

}  // namespace

constinit const SensorType tracks_type = plain<kForm>({
    .word = {"tracks", kKeys, {}, true},
    .base_port = 28000,
    .list = "tracks",
    .columns = kColumns,
    .derived = &kDerived,
    .parse =
        [](const world::World& world) {
          return parse_derived_rows(world, tracks_type, kMostObjects, kMostObjects, 10.0);
        },
    .make = no_backend,
});

}  // namespace sf::sensors
