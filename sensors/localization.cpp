#include "sensors/localization.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/time.h"
#include "sensors/derived/derived_type.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

enum Port : std::uint8_t { kEncoders, kGyros, kReceivers, kPoses };

/// Columns of a derived sensor with a pose: x, y, yaw, `valid` and the covariance.
constexpr std::size_t kValidAt = 3, kCovarianceAt = 4, kPoseNumbers = 10;

const world::Sensor& settings_of(const world::World& world, const WiredInput& input) {
  const SensorType& type = *find_sensor_type(input.type);
  std::uint32_t number = 0;
  for (const world::Sensor& sensor : world.movers[input.mover].sensors)
    if ((sensor.type == type.word.type || sensor.type == type.other_word.type) && number++ == input.sensor)
      return sensor;
  throw base::InputError("no such input");
}

class LocalizationSensor final : public sensorfarm::DerivedSensor {
 public:
  LocalizationSensor(const DerivedContext& context, const estimation::LocalizationOptions& options)
      : localization_(options), start_(context.site.start) {
    for (const sensorfarm::DerivedInput& input : context.site.inputs) add_input(input);
    const std::vector<double> noise = tuple(context.settings, "noise", 2, "[metres degrees]").value_or(kNoise);
    const double position = noise[0] * context.settings.metres_per_unit;
    const double yaw = noise[1] * context.settings.radians_per_unit;
    if (!(position > 0.0 && position <= 1e6 && yaw > 0.0 && yaw <= 10.0))
      refuse(context.settings, "noise", "'noise' expects two standard deviations above 0: [metres degrees]");
    covariance_ = {position * position, 0.0, 0.0, position * position, 0.0, yaw * yaw};
  }

  void take(std::uint32_t input, const sensorfarm::Reading& reading) override {
    const std::int64_t time = base::nanoseconds(reading.time);
    begin(time);
    const std::span<const double> v = reading.values;
    const Input& from = inputs_[input];
    if (from.port == kEncoders) localization_.add_encoder(time, v[0], v[1]);
    if (from.port == kGyros) localization_.add_gyro(time, v[0]);
    if (from.port == kReceivers) {
      // The antenna moves with the robot: its position uses the estimated heading.
      const double yaw = localization_.predict(time).estimate.X_WM.yaw;
      const glm::dvec2 p = origin_of({v[0], v[1]}, yaw, {from.X_RS.x, from.X_RS.y});
      localization_.add_gps(time, p.x, p.y, v[2]);
    }
    if (from.port == kPoses) take_pose(time, v, from.stated);
  }

  void add_input(const sensorfarm::DerivedInput& input) final {
    const std::vector<std::string>& columns = input.sensor.columns;
    const bool stated = columns.size() >= kPoseNumbers && columns[kValidAt] == "valid";
    inputs_.push_back({input.port, input.sensor.X_RS, stated});
  }

  void read(double seconds, sensorfarm::DerivedReading out) override {
    const std::int64_t time = base::nanoseconds(seconds);
    begin(time);
    const estimation::Prediction prediction = localization_.predict(time);
    out.valid[0] = prediction.status != estimation::Prediction::Status::none;
    if (out.valid[0] == 0) return;
    const base::Pose& X = prediction.estimate.X_WM;
    out.values[0] = X.x, out.values[1] = X.y, out.values[2] = X.yaw;
    double* to = out.covariance.data();
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = row; column < 3; ++column)
        *to++ = prediction.estimate.covariance[row * estimation::kComponents + column];
  }

 private:
  struct Input {
    std::uint32_t port;
    sensorfarm::Pose X_RS;
    bool stated;  ///< readings have `valid` and a covariance
  };
  inline static const std::vector<double> kNoise{0.05, 0.02 * 180.0 / M_PI};

  /// A known start pose is that at the first call.
  void begin(std::int64_t time) {
    if (!std::exchange(begun_, true) && std::isfinite(start_.x))
      localization_.add_pose(time, {start_.x, start_.y, start_.z, start_.yaw}, estimation::kKnownStart);
  }

  void take_pose(std::int64_t time, std::span<const double> v, bool stated) {
    if (stated && v[kValidAt] == 0.0) return;
    std::array<double, 6> covariance = covariance_;
    if (stated && std::isfinite(v[kCovarianceAt])) std::copy_n(v.begin() + kCovarianceAt, 6, covariance.begin());
    localization_.add_pose(time, {v[0], v[1], 0.0, v[2]}, covariance);
  }

  estimation::Localization localization_;
  sensorfarm::Pose start_;
  std::vector<Input> inputs_;
  std::array<double, 6> covariance_{};  ///< of a pose that states none
  bool begun_ = false;
};

std::unique_ptr<sensorfarm::DerivedSensor> make_localization(const DerivedContext& context) {
  PositionSensors sensors;
  bool located = false;
  for (const WiredInput& input : context.inputs) {
    if (input.mover != context.spec.mover && input.port != kPoses)
      refuse(context.settings, "inputs", "encoders, gyros and receivers of a localization are those of its own robot");
    if (input.port == kPoses) located = true;
    if (input.port == kPoses) continue;
    const world::Sensor& settings = settings_of(context.world, input);
    const world::Mover& mover = context.world.movers[input.mover];
    if (input.port == kEncoders) sensors.wheels = read_encoder(settings, mover);
    if (input.port == kGyros) sensors.gyro = read_gyro(settings);
    if (input.port == kReceivers) sensors.gps = read_gps(settings);
  }
  if (!located && !sensors.wheels && !sensors.gps)
    refuse(context.settings, "inputs", "a localization needs an encoder, a gps or a pose");
  return std::make_unique<LocalizationSensor>(context,
                                              localization_options(context.world.movers[context.spec.mover], sensors));
}

constexpr std::string_view kEncoderColumns[] = {"left_m", "right_m"}, kGyroColumns[] = {"rate_rad_s"},
                           kGpsColumns[] = {"x_m", "y_m", "hdop"}, kPoseColumns[] = {"x_m", "y_m", "yaw_rad"};
constexpr DerivedPort kPorts[] = {
    {"encoder", kEncoderColumns}, {"gyro", kGyroColumns}, {"gps", kGpsColumns}, {"pose", kPoseColumns, 0, 4}};
constexpr DerivedForm kDerived{kPorts, 3, true, make_localization};

constexpr Column kColumns[] = {{"x_m"},   {"y_m"},         {"yaw_rad"}, {"valid", 1, true}, {"xx_m2"},
                               {"xy_m2"}, {"x_yaw_m_rad"}, {"yy_m2"},   {"y_yaw_m_rad"},    {"yaw_yaw_rad2"}};
constexpr PlainNumber kReal{.real = true};
constexpr PlainNumber kNumbers[] = {{5e-3}, {5e-3}, {1e-6}, {1.0, 0.0, 1.0}, kReal, kReal, kReal, kReal, kReal, kReal};
constexpr PlainForm kForm{kLocalization, "localization", kNumbers};

}  // namespace

estimation::LocalizationOptions localization_options(const world::Mover& mover, const PositionSensors& sensors) {
  estimation::LocalizationOptions options{.sideways = mover.drive == world::Drive::omni};
  if (const auto& wheels = sensors.wheels)
    options.encoder = {
        .per_count = wheels->per_count, .angle_step = wheels->angle_step, .slip = wheels->slip, .track = wheels->track};
  if (sensors.gyro) options.gyro = {sensors.gyro->noise, sensors.gyro->bias};
  // Receivers without noise still have the error of their latency and of rounding.
  if (sensors.gps) options.gps_noise = std::max(sensors.gps->noise, 1e-3);
  return options;
}

constinit const SensorType localization_type = plain<kForm>({
    .word = {"localization", kDerivedKeys, {}, true},
    .base_port = 64000,
    .list = "",
    .columns = kColumns,
    .derived = &kDerived,
    .parse = [](const world::World& world) { return parse_derived(world, localization_type, 1, 20.0); },
    .make = no_backend,
});

}  // namespace sf::sensors
