#pragma once
// Base class of derived sensors that state a robot's pose: their inputs, known start, columns and covariance.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/time.h"
#include "sensors/derived/derived_type.h"
#include "sensors/localization.h"
#include "sensors/plain_packets.h"

namespace sf::sensors {

/// Rows of the ports. Those of further ones follow.
enum PosePort : std::uint8_t { kEncoders, kGyros, kReceivers, kPoses, kFinders, kImus };
inline constexpr std::string_view kEncoderColumns[] = {"left_m", "right_m"}, kGyroColumns[] = {"rate_rad_s"},
                                  kGpsColumns[] = {"x_m", "y_m", "hdop"}, kPoseColumns[] = {"x_m", "y_m", "yaw_rad"};

/// Columns of a pose, `valid` and the covariance, and their forms in packets.
inline constexpr std::array<Column, 10> kPoseRow{{{"x_m"},
                                                  {"y_m"},
                                                  {"yaw_rad"},
                                                  {"valid", 1, true},
                                                  {"xx_m2"},
                                                  {"xy_m2"},
                                                  {"x_yaw_m_rad"},
                                                  {"yy_m2"},
                                                  {"y_yaw_m_rad"},
                                                  {"yaw_yaw_rad2"}}};
inline constexpr PlainNumber kReal{.real = true};
inline constexpr std::array<PlainNumber, kPoseRow.size()> kPoseForms{
    {{5e-3}, {5e-3}, {1e-6}, {1.0, 0.0, 1.0}, kReal, kReal, kReal, kReal, kReal, kReal}};

/// Returns the columns of a pose, or their forms, with further ones.
template <class T, std::size_t N, std::size_t M>
constexpr std::array<T, N + M> joined(const std::array<T, N>& pose, const std::array<T, M>& more) {
  std::array<T, N + M> all{};
  std::copy(more.begin(), more.end(), std::copy(pose.begin(), pose.end(), all.begin()));
  return all;
}

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
    const bool turns = from.port == kGyros || from.port == kImus;
    if (!turns || time > rolled_.time) flush();
    if (turns) filter_.add_gyro(time, from.port == kImus ? glm::dot(up_, {v[0], v[1], v[2]}) : v[0]);
    if (from.port == kEncoders) rolled_ = {time, v[0], v[1]};
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
    flush();
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

  /// Passes the encoder reading that waits to the filter.
  void flush() {
    if (rolled_.time >= 0) filter_.add_encoder(rolled_.time, rolled_.left, rolled_.right);
    rolled_.time = -1;
  }

  Filter filter_;
  std::vector<sensorfarm::DerivedInput> inputs_;
  glm::dvec3 up_{0.0, 0.0, 1.0};  ///< the robot's z axis in the frame of its imu

 private:
  struct Rolled {
    std::int64_t time = -1;  ///< [ns]; -1: none
    double left = 0.0, right = 0.0;
  };
  /// The newest encoder reading waits for a gyro reading of the same time, which comes first in the filter's order:
  /// else each would be applied again.
  Rolled rolled_;
  sensorfarm::Pose start_;
  bool begun_ = false;
};

}  // namespace sf::sensors
