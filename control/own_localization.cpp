#include "control/own_localization.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/elementary.h"
#include "base/error.h"
#include "sensors/monitor.h"

namespace sf::control {

namespace {

constexpr float kFoundHeading = 0.5f;  // [rad] standard deviation below which a robot is no longer lost

const world::Sensor* first_sensor(const world::Mover& mover, std::string_view type) {
  const auto found =
      std::find_if(mover.sensors.begin(), mover.sensors.end(), [&](const auto& sensor) { return sensor.type == type; });
  return found == mover.sensors.end() ? nullptr : &*found;
}

/// @throws base::InputError for a robot without encoders
PositionSensors required_sensors_of(const world::Mover& mover) {
  PositionSensors sensors = position_sensors_of(mover);
  if (sensors.wheels) return sensors;
  throw base::InputError("'localize' estimates a robot's pose from its own sensors, but '" + mover.name +
                         "' has no encoders; expected encoder( ... ) in its definition, and gyro( ... ) and "
                         "gps( ... ) for a pose that does not drift");
}

/// Returns X_BC, given X_AB and X_AC.
base::Pose relative(const base::Pose& X_AB, const base::Pose& X_AC) {
  const glm::dvec2 p = base::rotate(-X_AB.yaw, {X_AC.x - X_AB.x, X_AC.y - X_AB.y});
  return {p.x, p.y, X_AC.z - X_AB.z, X_AC.yaw - X_AB.yaw};
}

}  // namespace

PositionSensors position_sensors_of(const world::Mover& mover) {
  PositionSensors own;
  constexpr std::array<std::string_view, 3> kTypes{"encoder", "gyro", "gps"};
  for (std::size_t kind = 0; kind < kTypes.size(); ++kind)
    if (const world::Sensor* sensor = first_sensor(mover, kTypes[kind])) own.add(kind, *sensor, mover);
  return own;
}

bool can_localize(const world::Mover& mover) { return first_sensor(mover, "encoder") != nullptr; }

void LocalizationError::add(const base::Pose& estimated, const base::Pose& truth) {
  const double distance = base::hypot(estimated.x - truth.x, estimated.y - truth.y);
  const double turned = base::wrap_angle(estimated.yaw - truth.yaw);
  add({1, distance * distance, turned * turned, distance, std::abs(turned)});
}

void LocalizationError::add(const LocalizationError& other) {
  steps += other.steps;
  squares += other.squares;
  yaw_squares += other.yaw_squares;
  max = std::max(max, other.max);
  yaw_max = std::max(yaw_max, other.yaw_max);
}

double LocalizationError::rms() const {
  return std::sqrt(squares / static_cast<double>(std::max<std::uint64_t>(steps, 1)));
}

double LocalizationError::yaw_rms() const {
  return std::sqrt(yaw_squares / static_cast<double>(std::max<std::uint64_t>(steps, 1)));
}

OwnLocalization::OwnLocalization(const world::Mover& mover, bool known_start, bool monitored)
    : first_(estimation::Localization({})), known_start_(known_start) {
  const PositionSensors sensors = required_sensors_of(mover);
  if (monitored && !sensors.gyro && !sensors.gps)
    throw base::InputError("'monitor' compares a robot's own sensors, but '" + mover.name +
                           "' has encoders only; expected gyro( ... ) or gps( ... ) in its definition");
  if (monitored)
    first_ = sensors::monitor_of(mover, sensors, {});
  else
    first_ = estimation::Localization(sensors::localization_options(mover, sensors));
  last_.fill(std::numeric_limits<std::int64_t>::min());
}

ControllerInput OwnLocalization::localize(const ControllerInput& input) {
  if (!filter_) {
    filter_ = first_;
    if (known_start_) add_pose(std::max<std::int64_t>(input.time, 0), input.state.X_WM, estimation::kKnownStart);
  }
  for (const base::ReadingBlock& reading : input.readings)
    if (reading.sensor == 0) take(reading);
  for (const MeasuredPose& pose : input.poses) add_pose(pose.time, pose.X_WM, pose.covariance);
  if (auto* monitor = std::get_if<estimation::LocalizationMonitor>(&*filter_)) monitor->update(input.time);

  ControllerInput seen = input;
  const estimation::Prediction prediction = predict(input.time);
  // Satellites alone do not show the heading of a robot at rest.
  const bool fixed = prediction.status != estimation::Prediction::Status::none;
  known_start_ = known_start_ || (fixed && quality_of(prediction).covariance[5] < kFoundHeading * kFoundHeading);
  if (!fixed || !known_start_) {
    quality_ = {.stated = true, .stale = true, .age = base::kNoStateYet};
    return input;
  }
  const estimation::Estimate& now = prediction.estimate;
  const auto at_height = [&](base::Pose X_WM) {
    X_WM.z = input.state.X_WM.z;
    return X_WM;
  };
  seen.state.X_WM = at_height(now.X_WM);
  seen.state.velocity = now.velocity;
  state_ = seen.state;
  state_.time = input.time;
  quality_ = quality_of(prediction);
  readings_.assign(input.readings.begin(), input.readings.end());
  std::pair last{input.time, now.X_WM};  // most readings have one time
  for (base::ReadingBlock& reading : readings_) {
    const base::Pose X_MS = relative(reading.X_WM, reading.X_WS);
    if (reading.time != last.first) last = {reading.time, predict(reading.time).estimate.X_WM};
    reading.X_WM = at_height(last.second);
    reading.X_WS = base::compose(reading.X_WM, X_MS);
  }
  seen.readings = readings_;
  error_.add(now.X_WM, input.state.X_WM);
  return seen;
}

estimation::Prediction OwnLocalization::predict(std::int64_t time) const {
  return std::visit([&](const auto& filter) { return filter.predict(time); }, *filter_);
}

void OwnLocalization::add_pose(std::int64_t time, const base::Pose& X_WM, const std::array<double, 6>& covariance) {
  std::visit([&](auto& filter) { filter.add_pose(time, X_WM, covariance); }, *filter_);
}

void OwnLocalization::take(const base::ReadingBlock& reading) {
  if (reading.time <= last_[reading.type]) return;  // already used
  const std::span<const double> v = reading.values;
  const auto add = [&](const auto& call) { std::visit([&](auto& filter) { call(filter); }, *filter_); };
  if (reading.type == sensors::kEncoder && v.size() >= 2)
    add([&](auto& filter) { filter.add_encoder(reading.time, v[0], v[1]); });
  if (reading.type == sensors::kGyro && !v.empty()) add([&](auto& filter) { filter.add_gyro(reading.time, v[0]); });
  if (reading.type == sensors::kGps && v.size() >= 3) {
    // The antenna moves with the robot: its position uses the estimated heading.
    const base::Pose X_MS = relative(reading.X_WM, reading.X_WS);
    const double yaw = predict(reading.time).estimate.X_WM.yaw;
    const glm::dvec2 p = sensors::origin_of({v[0], v[1]}, yaw, {X_MS.x, X_MS.y});
    add([&](auto& filter) { filter.add_gps(reading.time, p.x, p.y, v[2]); });
  }
  last_[reading.type] = reading.time;
}

}  // namespace sf::control
