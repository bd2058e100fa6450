#include "sensors/location.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "sensors/aggregation.h"
#include "sensors/gps.h"
#include "sensors/plain_packets.h"
#include "sensors/pose_sensor.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::uint32_t kReceiver = 0, kPose = 1;  // rows of the ports

/// Places in a derived pose (kPoseRow).
constexpr std::size_t kYawAt = 2, kValidAt = 3, kCovarianceAt = 4;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kUnstated{kUnknown, kUnknown, kUnknown};

bool states_covariance(const sensorfarm::SensorInfo& sensor) {
  return sensor.columns.size() >= kPoseRow.size() && sensor.columns[kCovarianceAt] == kPoseRow[kCovarianceAt].name;
}

class LocationSensor final : public sensorfarm::DerivedSensor {
 public:
  LocationSensor(const DerivedContext& context, const AggregationSettings& settings)
      : aggregation_(settings, places_of(context.inputs)), inputs_(context.site.inputs) {
    for (const WiredInput& input : context.inputs)
      gps_noise_.push_back(input.port == kReceiver ? read_gps(input_settings(context.world, input)).noise : 0.0);
  }

  void take(std::uint32_t input, const sensorfarm::Reading& reading) override {
    aggregation_.take(input, reading.time,
                      inputs_[input].port == kReceiver ? fix(input, reading) : pose(input, reading));
  }

  void read(double time, sensorfarm::DerivedReading out) override {
    const std::optional<Aggregate> now = aggregation_.at(time);
    out.valid[0] = now.has_value();
    double* const extra = out.values.data() + 2;
    extra[0] = now ? now->source : NAN;
    extra[1] = now ? now->age : NAN;
    if (!now) return;
    out.values[0] = now->estimate.value.x, out.values[1] = now->estimate.value.y;
    std::ranges::copy(now->estimate.covariance, out.covariance.begin());
  }

 private:
  /// The stated covariance, or that of the settings.
  estimation::Stated stated(std::uint32_t input, glm::dvec2 p, const std::array<double, 3>& covariance) const {
    const double noise = aggregation_.noise(input);
    if (noise > 0.0) return {p, {noise * noise, 0.0, noise * noise}};
    return {p, covariance};
  }

  std::optional<estimation::Stated> fix(std::uint32_t input, const sensorfarm::Reading& reading) const {
    const std::span<const double> v = reading.values;
    if (!std::isfinite(v[0])) return std::nullopt;
    const double variance = 0.5 * gps_noise_[input] * gps_noise_[input] * v[2] * v[2];  // of each axis
    estimation::Stated at = stated(input, {v[0], v[1]}, {variance, 0.0, variance});
    const glm::dvec2 antenna{inputs_[input].sensor.X_RS.x, inputs_[input].sensor.X_RS.y};
    if (std::isfinite(yaw_)) {
      at.value = origin_of(at.value, yaw_, antenna);
    } else {
      at.covariance[0] += 0.5 * glm::dot(antenna, antenna);
      at.covariance[2] += 0.5 * glm::dot(antenna, antenna);
    }
    return at;
  }

  std::optional<estimation::Stated> pose(std::uint32_t input, const sensorfarm::Reading& reading) {
    const std::span<const double> v = reading.values;
    const bool derived = states_covariance(inputs_[input].sensor);
    if (!std::isfinite(v[0]) || (derived && v[kValidAt] == 0.0)) return std::nullopt;
    yaw_ = v[kYawAt];
    const double* const c = v.data() + kCovarianceAt;
    return stated(input, {v[0], v[1]}, derived ? std::array{c[0], c[1], c[3]} : kUnstated);
  }

  Aggregation aggregation_;
  std::vector<sensorfarm::DerivedInput> inputs_;
  std::vector<double> gps_noise_;  ///< [m] per input
  double yaw_ = NAN;               ///< [rad] newest
};

std::unique_ptr<sensorfarm::DerivedSensor> make_location(const DerivedContext& context) {
  for (const WiredInput& input : context.inputs)
    if (input.mover != context.spec.mover)
      refuse(context.settings, "inputs", "the inputs of a location are sensors of its own robot");
  const AggregationSettings settings = read_aggregation(context, context.world.movers[context.spec.mover].max_forward);
  require_errors(context, settings, [&](std::size_t i) {
    return context.inputs[i].port == kReceiver || states_covariance(context.site.inputs[i].sensor);
  });
  return std::make_unique<LocationSensor>(context, settings);
}

constexpr std::string_view kPoseColumns[] = {"x_m", "y_m", "yaw_rad"};
constexpr DerivedPort kPorts[] = {{"gps", kGpsColumns, 0, 8}, {"pose", kPoseColumns, 0, 8}};
constexpr DerivedForm kDerived{.ports = kPorts, .quantities = 2, .covariance = true, .extra = 2, .make = make_location};

constexpr std::string_view kKeys[] = {kDerivedKeys[0], kDerivedKeys[1], kChooseKey, kMaxAgeKey, kDriftKey, kNoiseKey};
constexpr Column kColumns[] = {{"x_m"},   {"y_m"},   {"valid", 1, true}, {"xx_m2"},
                               {"xy_m2"}, {"yy_m2"}, {"source"},         {"age_s"}};
constexpr PlainNumber kNumbers[] = {{5e-3}, {5e-3}, {1.0, 0.0, 1.0}, kReal, kReal, kReal, {1.0, -1.0, 63.0}, kReal};
constexpr PlainForm kForm{kLocation, "location", kNumbers};

}  // namespace

constinit const SensorType location_type = plain<kForm>({
    .word = {"location", kKeys, {}, true},
    .base_port = 24000,
    .list = "",
    .columns = kColumns,
    .derived = &kDerived,
    .parse = [](const world::World& world) { return parse_derived(world, location_type, 1, 5.0); },
    .make = no_backend,
});

}  // namespace sf::sensors
