#include "sensors/localization.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/elementary.h"
#include "base/error.h"
#include "robots/car_model.h"
#include "sensors/fiducial.h"
#include "sensors/imu.h"
#include "sensors/plain_packets.h"
#include "sensors/pose_sensor.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

/// Columns of a derived sensor with a pose: x, y, yaw, `valid` and the covariance.
constexpr std::size_t kValidAt = 3, kCovarianceAt = 4, kPoseNumbers = 10;

/// A fiducial finder of the robot, and the fiducials that it detects and that stand still, by id.
struct LandmarkFinder {
  FiducialFinder settings;
  std::map<std::uint32_t, glm::dvec2> landmarks;  ///< [m] world frame
};

/// @throws base::InputError if there is none, or if two have the same id
LandmarkFinder landmark_finder(const DerivedContext& context, const WiredInput& input) {
  LandmarkFinder finder{read_finder(input_settings(context.world, input)), {}};
  const std::uint32_t key = finder.settings.key;
  for (const world::Fiducial& fiducial : context.world.fiducials) {
    if (fiducial.key != key || context.world.models[fiducial.model].mover != world::kNone) continue;
    if (!finder.landmarks.emplace(fiducial.id, glm::dvec2{fiducial.X_BF.x, fiducial.X_BF.y}).second)
      refuse(context.settings, "inputs",
             fmt::format("two models that stand still have fiducial_return {} (fiducial_key {}); a localization needs "
                         "different ones",
                         fiducial.id, key));
  }
  if (finder.landmarks.empty())
    refuse(context.settings, "inputs",
           fmt::format("no model that stands still has a fiducial_return with fiducial_key {}; a localization takes "
                       "those as landmarks",
                       key));
  return finder;
}

class LocalizationSensor final : public PoseSensor<estimation::Localization> {
 public:
  LocalizationSensor(const DerivedContext& context, const estimation::LocalizationOptions& options)
      : PoseSensor(context, estimation::Localization(options)) {
    const std::vector<double> noise = tuple(context.settings, "noise", 2, "[metres degrees]").value_or(kNoise);
    const double position = noise[0] * context.settings.metres_per_unit;
    const double yaw = noise[1] * context.settings.radians_per_unit;
    if (!(position > 0.0 && position <= 1e6 && yaw > 0.0 && yaw <= 10.0))
      refuse(context.settings, "noise", "'noise' expects two standard deviations above 0: [metres degrees]");
    covariance_ = {position * position, 0.0, 0.0, position * position, 0.0, yaw * yaw};
    for (std::uint32_t i = 0; i < context.inputs.size(); ++i)
      if (context.inputs[i].port == kFinders)
        finders_.emplace(i, landmark_finder(context, context.inputs[i]));
      else if (context.inputs[i].port == kImus)
        up_ = glm::transpose(read_imu(input_settings(context.world, context.inputs[i])).X_MS.R)[2];
  }

  void take(std::uint32_t input, const sensorfarm::Reading& reading) override {
    PoseSensor::take(input, reading);
    if (inputs_[input].port == kPoses) take_pose(reading, inputs_[input].sensor.columns);
    if (const auto finder = finders_.find(input); finder != finders_.end())
      take_sightings(reading, finder->second, inputs_[input].sensor.X_RS);
  }

 private:
  inline static const std::vector<double> kNoise{0.05, 0.02 * 180.0 / M_PI};

  void take_pose(const sensorfarm::Reading& reading, const std::vector<std::string>& columns) {
    const std::span<const double> v = reading.values;
    const bool stated = columns.size() >= kPoseNumbers && columns[kValidAt] == "valid";
    if (stated && v[kValidAt] == 0.0) return;
    std::array<double, 6> covariance = covariance_;
    if (stated && std::isfinite(v[kCovarianceAt])) std::copy_n(v.begin() + kCovarianceAt, 6, covariance.begin());
    filter_.add_pose(base::nanoseconds(reading.time), {v[0], v[1], 0.0, v[2]}, covariance);
  }

  /// Fiducials that move, and those too far for their id, are left out.
  void take_sightings(const sensorfarm::Reading& reading, const LandmarkFinder& finder, const sensorfarm::Pose& X_RS) {
    for (std::size_t k = 0; k + kFiducialNumbers <= reading.values.size(); k += kFiducialNumbers) {
      const double id = reading.values[k], range = reading.values[k + 2];
      if (!(id > 0.0)) continue;
      const auto landmark = finder.landmarks.find(static_cast<std::uint32_t>(id));
      if (landmark == finder.landmarks.end()) continue;
      const auto [s, c] = base::sin_cos(reading.values[k + 3] + X_RS.yaw);
      const double along = std::max(finder.settings.range_noise, kLeastNoise);
      const double across = range * std::max(finder.settings.bearing_noise, kLeastNoise) + kLeastNoise;
      const double a = along * along, b = across * across;
      filter_.add_sighting(base::nanoseconds(reading.time), landmark->second, {X_RS.x + range * c, X_RS.y + range * s},
                           {a * c * c + b * s * s, (a - b) * c * s, a * s * s + b * c * c});
    }
  }

  static constexpr double kLeastNoise = 1e-3;        ///< [m], [rad]
  std::array<double, 6> covariance_{};               ///< of a pose that states none
  std::map<std::uint32_t, LandmarkFinder> finders_;  ///< by input
};

std::unique_ptr<sensorfarm::DerivedSensor> make_localization(const DerivedContext& context) {
  const PositionSensors sensors = position_inputs(context);
  const bool located = std::ranges::any_of(
      context.inputs, [](const WiredInput& input) { return input.port == kPoses || input.port == kFinders; });
  const auto turns = std::ranges::count_if(
      context.inputs, [](const WiredInput& input) { return input.port == kGyros || input.port == kImus; });
  if (turns > 1) refuse(context.settings, "inputs", "a localization takes a gyro or an imu, not both");
  if (!located && !sensors.wheels && !sensors.gps)
    refuse(context.settings, "inputs", "a localization needs an encoder, a gps, a pose or a fiducial");
  return std::make_unique<LocalizationSensor>(context,
                                              localization_options(context.world.movers[context.spec.mover], sensors));
}

constexpr std::string_view kFinderColumns[] = {"id", "fiducial_type", "range_m", "bearing_rad"};
constexpr std::string_view kRateColumns[] = {"rate_x_rad_s", "rate_y_rad_s", "rate_z_rad_s"};
constexpr DerivedPort kPorts[] = {
    {"encoder", kEncoderColumns},       {"gyro", kGyroColumns}, {"gps", kGpsColumns}, {"pose", kPoseColumns, 0, 4},
    {"fiducial", kFinderColumns, 0, 4}, {"imu", kRateColumns}};
constexpr DerivedForm kDerived{.ports = kPorts, .quantities = 3, .covariance = true, .make = make_localization};

constexpr std::string_view kKeys[] = {kDerivedKeys[0], kDerivedKeys[1], "noise"};
constexpr PlainForm kForm{kLocalization, "localization", kPoseForms};

}  // namespace

const world::Sensor& input_settings(const world::World& world, const WiredInput& input) {
  const SensorType& type = *find_sensor_type(input.type);
  std::uint32_t number = 0;
  for (const world::Sensor& sensor : world.movers[input.mover].sensors)
    if ((sensor.type == type.word.type || sensor.type == type.other_word.type) && number++ == input.sensor)
      return sensor;
  throw base::InputError("no such input");
}

void PositionSensors::add(std::size_t kind, const world::Sensor& settings, const world::Mover& mover) {
  if (kind == kEncoders) wheels = read_encoder(settings, mover);
  if (kind == kGyros) gyro = read_gyro(settings);
  if (kind == kReceivers) gps = read_gps(settings);
  const SensorSpec spec = common_spec(settings, 0, 0);
  periods[kind] = 1.0 / (kind == kReceivers ? rate_of(settings, kGpsRate) : spec.rate);
  latencies[kind] = spec.latency;
}

/// Returns the errors of an imu's yaw rate as those of a gyro: a bias that wanders counts as one that is constant.
Gyro yaw_gyro(const world::Sensor& settings) {
  const TriadErrors errors = read_imu(settings).gyro;
  return {.bias = base::hypot(errors.bias, errors.drift.instability),
          .noise = errors.noise * std::sqrt(rate_of(settings, kImuRate)),
          .scale_error = errors.scale};
}

PositionSensors position_inputs(const DerivedContext& context) {
  PositionSensors sensors;
  for (const WiredInput& input : context.inputs) {
    if (input.mover != context.spec.mover)
      refuse(context.settings, "inputs",
             fmt::format("the inputs of a {} are sensors of its own robot", context.settings.type));
    if (input.port == kImus) sensors.gyro = yaw_gyro(input_settings(context.world, input));
    if (input.port >= kPoses) continue;
    sensors.add(input.port, input_settings(context.world, input), context.world.movers[input.mover]);
  }
  return sensors;
}

/// The localization knows where the axles are, and takes the tyres for those of a passenger car on dry asphalt.
estimation::LocalizationOptions::Tyres tyres_of(const world::Mover& mover) {
  const robots::CarModel car;
  return {.axle = 0.5 * mover.wheelbase, .sideslip = car.rear_load() / (car.rear_cornering() * robots::kGravity)};
}

estimation::LocalizationOptions localization_options(const world::Mover& mover, const PositionSensors& sensors) {
  estimation::LocalizationOptions options{.sideways = mover.drive == world::Drive::omni};
  if (const auto& wheels = sensors.wheels)
    options.encoder = {
        .per_count = wheels->per_count, .angle_step = wheels->angle_step, .slip = wheels->slip, .track = wheels->track};
  if (mover.dynamics.name == "car" && mover.drive == world::Drive::car) options.tyres = tyres_of(mover);
  if (sensors.gyro) options.gyro = {sensors.gyro->noise, sensors.gyro->bias, sensors.gyro->scale_error};
  // Receivers without noise still have the error of their latency and of rounding.
  if (sensors.gps) options.gps_noise = std::max(sensors.gps->noise, 1e-3);
  return options;
}

constinit const SensorType localization_type = plain<kForm>({
    .word = {"localization", kKeys, {}, true},
    .base_port = 64000,
    .list = "",
    .columns = kPoseRow,
    .derived = &kDerived,
    .parse = [](const world::World& world) { return parse_derived(world, localization_type, 1, 20.0); },
    .make = no_backend,
});

}  // namespace sf::sensors
