#pragma once
// What derived sensors with a robot's pose have in common: inputs, a known start, and the pose with its covariance.

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/time.h"
#include "sensors/derived/derived_type.h"
#include "sensors/localization.h"

namespace sf::sensors {

/// Rows of the ports. Those of further ones follow.
enum PosePort : std::uint8_t { kEncoders, kGyros, kReceivers, kPoses };
inline constexpr std::string_view kEncoderColumns[] = {"left_m", "right_m"}, kGyroColumns[] = {"rate_rad_s"},
                                  kGpsColumns[] = {"x_m", "y_m", "hdop"};

/// Returns the inputs that are sensors of the robot.
/// @throws base::InputError for sensors of other robots, except for poses
PositionSensors position_inputs(const DerivedContext& context);
/// Returns the world file's settings of an input. @pre it is not derived
const world::Sensor& input_settings(const world::World& world, const WiredInput& input);

/// @tparam Filter estimation::Localization, or one with the same functions
template <class Filter>
class PoseSensor : public sensorfarm::DerivedSensor {
 public:
  PoseSensor(const DerivedContext& context, const Filter& filter) : filter_(filter), start_(context.site.start) {
    for (const sensorfarm::DerivedInput& input : context.site.inputs) inputs_.push_back(input);
  }

  void take(std::uint32_t input, const sensorfarm::Reading& reading) override {
    const std::int64_t time = base::nanoseconds(reading.time);
    begin(time);
    const std::span<const double> v = reading.values;
    const sensorfarm::DerivedInput& from = inputs_[input];
    if (from.port == kEncoders) filter_.add_encoder(time, v[0], v[1]);
    if (from.port == kGyros) filter_.add_gyro(time, v[0]);
    if (from.port != kReceivers) return;
    // The antenna moves with the robot: its position uses the estimated heading.
    const double yaw = filter_.predict(time).estimate.X_WM.yaw;
    const glm::dvec2 p = origin_of({v[0], v[1]}, yaw, {from.sensor.X_RS.x, from.sensor.X_RS.y});
    filter_.add_gps(time, p.x, p.y, v[2]);
  }

  void add_input(const sensorfarm::DerivedInput& input) final { inputs_.push_back(input); }

  void read(double seconds, sensorfarm::DerivedReading out) override {
    const std::int64_t time = base::nanoseconds(seconds);
    begin(time);
    const estimation::Prediction prediction = filter_.predict(time);
    out.valid[0] = prediction.status != estimation::Prediction::Status::none;
    if (out.valid[0] == 0) return;
    const base::Pose& X = prediction.estimate.X_WM;
    out.values[0] = X.x, out.values[1] = X.y, out.values[2] = X.yaw;
    double* to = out.covariance.data();
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = row; column < 3; ++column)
        *to++ = prediction.estimate.covariance[row * estimation::kComponents + column];
  }

 protected:
  /// A known start pose is that at the first call.
  void begin(std::int64_t time) {
    if (!std::exchange(begun_, true) && std::isfinite(start_.x))
      filter_.add_pose(time, {start_.x, start_.y, start_.z, start_.yaw}, estimation::kKnownStart);
  }

  Filter filter_;
  std::vector<sensorfarm::DerivedInput> inputs_;

 private:
  sensorfarm::Pose start_;
  bool begun_ = false;
};

}  // namespace sf::sensors
