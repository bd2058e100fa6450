#include "sensors/features.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/echo.h"
#include "base/elementary.h"
#include "sensors/beam_columns.h"
#include "sensors/camera.h"
#include "sensors/cones/rangers.h"
#include "sensors/fiducial.h"
#include "sensors/infrared.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "sensors/lidar.h"
#include "sensors/plain_packets.h"
#include "sensors/pose_sensor.h"
#include "sensors/settings.h"
#include "sensors/sonar.h"

namespace sf::sensors {

namespace {

using estimation::Feature;
using estimation::FeatureKind;

/// Returns the range of a row, or NaN without a valid echo. @param width numbers of a row
double echo_range(const sensorfarm::Reading& reading, std::size_t row, std::size_t width, base::RangeLimits limits) {
  const double range = reading.values[row * width];
  const bool near =
      row < reading.flags.size() && reading.flags[row] == static_cast<std::uint8_t>(base::QualityFlag::too_near);
  return !near && base::echo_of(range, limits) == base::Echo::valid ? range : NAN;
}

class LaserFeatures final : public FeatureSource {
 public:
  LaserFeatures(const LaserSettings& laser, const estimation::FeatureOptions& options)
      : limits_{laser.range_min, laser.range_max}, finder_(laser.X_MS, bearings_of(laser), noise_of(laser), options) {}

  std::span<const Feature> find(const sensorfarm::Reading& reading) override {
    ranges_.resize(reading.values.size());
    for (std::size_t i = 0; i < ranges_.size(); ++i) ranges_[i] = echo_range(reading, i, 1, limits_);
    return finder_.find(ranges_);
  }

 private:
  static std::vector<double> bearings_of(const LaserSettings& laser) {
    std::vector<double> bearings;
    for (std::uint32_t i = 0; i < laser.samples; ++i) bearings.push_back(raycast::bearing_of(laser, i));
    return bearings;
  }
  static estimation::EchoNoise noise_of(const LaserSettings& laser) {
    return {laser.noise.range_sigma, laser.noise.range_proportional, laser.noise.angle_sigma};
  }
  base::RangeLimits limits_;
  estimation::ScanFeatures finder_;
  std::vector<double> ranges_;
};

/// Of lidars and of cameras.
class ColumnFeatures final : public FeatureSource {
 public:
  ColumnFeatures(BeamColumns columns, const estimation::EchoNoise& noise, const estimation::FeatureOptions& options)
      : columns_(std::move(columns)), finder_(columns_.X_MS(), columns_.bearings(), noise, options) {}

  std::span<const Feature> find(const sensorfarm::Reading& reading) override {
    return finder_.find(columns_.ranges(reading));
  }

 private:
  BeamColumns columns_;
  estimation::ScanFeatures finder_;
};

class ConeFeatures final : public FeatureSource {
 public:
  ConeFeatures(ConeArray array, bool infrared) : array_(std::move(array)), infrared_(infrared) {}

  std::span<const Feature> find(const sensorfarm::Reading& reading) override {
    found_.clear();
    const std::uint64_t number = number_of(reading.time), last = std::exchange(last_, number);
    for (std::uint32_t i = 0; i < array_.X_SC.size(); ++i) {
      if (last != kNoReading && !has_fired(i, array_.turns, number, last)) continue;
      const double range =
          echo_range(reading, i, infrared_ ? kInfraredColumns : 1, {array_.range_min, array_.range_max});
      if (std::isfinite(range))
        found_.push_back(
            estimation::cone_echo(base::compose(array_.row.X_MS, array_.X_SC[i]), range, sigma(range), array_.fov));
    }
    return found_;
  }

 private:
  static constexpr std::uint64_t kNoReading = ~std::uint64_t{0};

  /// Returns the sequence number of the reading at `time` [s].
  std::uint64_t number_of(double time) const {
    return static_cast<std::uint64_t>(std::max(std::llround((time - array_.row.phase) * array_.row.rate), 0ll));
  }
  double sigma(double range) const {
    return infrared_ ? infrared_sigma(range, {array_.range_min, array_.range_max}, array_.proportional)
                     : base::hypot(array_.sigma, array_.proportional * range);
  }
  ConeArray array_;
  bool infrared_;
  std::uint64_t last_ = kNoReading;  ///< number of the last reading
  std::vector<Feature> found_;
};

class TagFeatures final : public FeatureSource {
 public:
  TagFeatures(const FiducialFinder& finder, const base::Pose& X_MS)
      : X_MS_(X_MS), noise_{finder.range_noise, finder.bearing_noise, finder.orientation_noise} {}

  std::span<const Feature> find(const sensorfarm::Reading& reading) override {
    found_.clear();
    for (std::size_t i = 0; i + kFiducialNumbers <= reading.values.size(); i += kFiducialNumbers) {
      const auto v = reading.values.subspan(i, kFiducialNumbers);
      if (!std::isfinite(v[2] + v[3] + v[4])) continue;
      const double id = std::isfinite(v[0]) ? std::clamp(v[0], 0.0, 65535.0) : 0.0;
      found_.push_back(estimation::tag_at(X_MS_, v[2], v[3], v[4], noise_, static_cast<std::uint32_t>(id)));
    }
    return found_;
  }

 private:
  base::Pose X_MS_;
  std::array<double, 3> noise_;
  std::vector<Feature> found_;
};

class FeaturesSensor final : public sensorfarm::DerivedSensor {
 public:
  FeaturesSensor(std::unique_ptr<FeatureSource> source, const sensorfarm::Pose& X_RS)
      : source_(std::move(source)), p_RS_{X_RS.x, X_RS.y} {}

  void take(std::uint32_t, const sensorfarm::Reading& reading) override {
    time_ = reading.time;
    values_.assign(reading.values.begin(), reading.values.end());
    flags_.assign(reading.flags.begin(), reading.flags.end());
  }

  void read(double time, sensorfarm::DerivedReading out) override {
    std::ranges::fill(out.valid, std::uint8_t{0});
    if (!std::isfinite(time_)) return;
    sensorfarm::Reading newest;
    newest.time = time_, newest.values = values_, newest.flags = flags_;
    nearest_.clear();
    for (const Feature& feature : source_->find(newest)) nearest_.push_back(&feature);
    std::ranges::stable_sort(nearest_, {}, [&](const Feature* f) { return glm::length(f->p - p_RS_); });
    for (std::size_t row = 0; row < std::min(nearest_.size(), out.valid.size()); ++row) write(*nearest_[row], row, out);
    for (std::size_t row = 0; row < out.valid.size(); ++row)
      if (out.valid[row] != 0) out.values[kNumbersOfRow * row + 6] = std::max(time - time_, 0.0);
    time_ = NAN;
  }

 private:
  static constexpr std::size_t kNumbersOfRow = 7;  // without `valid` and the covariance

  static void write(const Feature& feature, std::size_t row, sensorfarm::DerivedReading& out) {
    const auto values = out.values.subspan(kNumbersOfRow * row, kNumbersOfRow);
    values[0] = feature.p.x, values[1] = feature.p.y, values[2] = feature.direction;
    values[3] = static_cast<double>(feature.kind), values[4] = feature.half_length, values[5] = feature.id;
    std::ranges::copy(feature.covariance, out.covariance.begin() + static_cast<std::ptrdiff_t>(6 * row));
    out.valid[row] = 1;
  }

  std::unique_ptr<FeatureSource> source_;
  glm::dvec2 p_RS_;
  double time_ = NAN;  ///< of the newest input; NaN: none since the last reading
  std::vector<double> values_;
  std::vector<std::uint8_t> flags_;
  std::vector<const Feature*> nearest_;
};

estimation::FeatureOptions feature_options(const world::Sensor& settings) {
  estimation::FeatureOptions options;
  options.shortest = length(settings, "shortest", options.shortest, 1e-3, 1e3);
  options.widest = length(settings, "widest", options.widest, 1e-3, 1e3);
  if (const auto size = tuple(settings, "objects", 2, "[length width]")) {
    options.size = settings.metres_per_unit * glm::dvec2{(*size)[0], (*size)[1]};
    if (!(options.size.x <= 1e3 && options.size.x >= options.size.y && options.size.y >= 1e-3))
      refuse(settings, "objects", "'objects' expects [length width], the length not below the width, both above 0");
  }
  return options;
}

std::unique_ptr<sensorfarm::DerivedSensor> make_features(const DerivedContext& context) {
  if (context.inputs.size() != 1 || context.inputs[0].mover != context.spec.mover)
    refuse(context.settings, "inputs",
           "features are those of one laser, lidar, camera, sonar, infrared or fiducial of its own robot");
  auto source = feature_source(context.world, context.inputs[0], feature_options(context.settings));
  if (source == nullptr)
    refuse(
        context.settings, "inputs",
        fmt::format("{} has no features; expected a laser, a lidar with rings, a camera, sonar, infrared or fiducial",
                    context.site.inputs[0].sensor.type));
  return std::make_unique<FeaturesSensor>(std::move(source), context.site.inputs[0].sensor.X_RS);
}

constexpr std::string_view kRangeColumns[] = {"range_m"}, kDepthColumns[] = {"depth_m"},
                           kTagColumns[] = {"id", "fiducial_type", "range_m", "bearing_rad", "orientation_rad"};
constexpr DerivedPort kPorts[] = {{"ranges", kRangeColumns}, {"depths", kDepthColumns}, {"fiducial", kTagColumns}};
constexpr DerivedForm kDerived{.ports = kPorts, .quantities = 3, .covariance = true, .extra = 4, .make = make_features};

constexpr std::string_view kKeys[] = {kDerivedKeys[0], kDerivedKeys[1], "most", "shortest", "widest", "objects"};
constexpr Column kColumns[] = {{"x_m"},
                               {"y_m"},
                               {"direction_rad"},
                               {"valid", 1, true},
                               {"xx_m2"},
                               {"xy_m2"},
                               {"x_direction_m_rad"},
                               {"yy_m2"},
                               {"y_direction_m_rad"},
                               {"direction_direction_rad2"},
                               {"kind", 1, true},
                               {"half_length_m"},
                               {"id", 1, true},
                               {"age_s"}};
constexpr PlainNumber kNumbers[] = {
    {1e-3}, {1e-3},          {1e-6},      {1.0, 0.0, 1.0},     kReal,      kReal, kReal, kReal, kReal,
    kReal,  {1.0, 0.0, 5.0}, {1e-3, 0.0}, {1.0, 0.0, 65535.0}, {1e-6, 0.0}};
static_assert(std::size(kColumns) == kFeatureNumbers && std::size(kNumbers) == kFeatureNumbers);
static_assert(kMostFeatures * kFeatureNumbers <= kMaxPlainWords);
constexpr PlainForm kForm{kFeatures, "features", kNumbers};

}  // namespace

std::unique_ptr<FeatureSource> feature_source(const world::World& world, const WiredInput& input,
                                              const estimation::FeatureOptions& options) {
  const world::Mover& mover = world.movers[input.mover];
  if (input.type == kLaser) {
    const LaserSettings laser = lasers_of(mover)[input.sensor];
    require_level(world, laser, "'features'");
    return std::make_unique<LaserFeatures>(laser, options);
  }
  constexpr std::uint8_t kOthers[] = {kLidar, kCamera, kSonar, kInfrared, kFiducial};
  if (std::ranges::find(kOthers, input.type) == std::end(kOthers)) return nullptr;
  const world::Sensor& settings = input_settings(world, input);
  if (input.type == kCamera) {
    CameraReader reader;
    const CameraSettings camera = reader.read(settings);
    BeamColumns columns(camera);
    const double angle = columns.step() / std::sqrt(12.0);  // of a pixel somewhere in its column
    return std::make_unique<ColumnFeatures>(
        std::move(columns), estimation::EchoNoise{.angle = angle, .squared = kColumnNoise * camera.depth_noise},
        options);
  }
  if (input.type == kLidar) {
    LidarReader reader;
    const LidarSettings lidar = reader.read(world, settings);
    if (lidar.beams->channels < 2) return nullptr;
    return std::make_unique<ColumnFeatures>(BeamColumns(lidar),
                                            estimation::EchoNoise{lidar.echo.sigma, lidar.echo.proportional}, options);
  }
  if (input.type == kFiducial) {
    base::Pose X_MS = common_spec(settings, input.mover, input.sensor).X_MS;
    return std::make_unique<TagFeatures>(read_finder(settings), X_MS);
  }
  const bool infrared = input.type == kInfrared;
  return std::make_unique<ConeFeatures>((infrared ? read_infrared : read_sonar)(settings, input.mover, input.sensor),
                                        infrared);
}

constinit const SensorType features_type = plain<kForm>({
    .word = {"features", kKeys, {}, true},
    .base_port = 26000,
    .list = "features",
    .columns = kColumns,
    .derived = &kDerived,
    .parse =
        [](const world::World& world) { return parse_derived_rows(world, features_type, 16, kMostFeatures, 10.0); },
    .make = no_backend,
});

}  // namespace sf::sensors
