#pragma once
// Estimates a controller's state from the robot's own encoders, gyro and GPS receiver, and from poses measured by a
// positioning system, in place of its true state (the shell's setting `localize`).

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "control/controller.h"
#include "robots/estimation/localization_monitor.h"
#include "sensors/localization.h"
#include "world/world.h"

namespace sf::control {

using sensors::PositionSensors;
/// @throws base::InputError for invalid settings of these sensors
PositionSensors position_sensors_of(const world::Mover& mover);
/// Returns whether a robot localizes itself unless its settings state otherwise: it has encoders.
bool can_localize(const world::Mover& mover);

/// Errors of a robot's estimated poses relative to its true ones, at the steps of its controller.
struct LocalizationError {
  std::uint64_t steps = 0;
  double squares = 0.0;      ///< [m^2] sum of squared horizontal distances
  double yaw_squares = 0.0;  ///< [rad^2] sum
  double max = 0.0;          ///< [m] largest distance
  double yaw_max = 0.0;      ///< [rad]

  void add(const base::Pose& estimated, const base::Pose& truth);
  void add(const LocalizationError& other);
  double rms() const;      ///< [m]; 0 without steps
  double yaw_rms() const;  ///< [rad]; 0 without steps
};

/// Called once per step. Uses the first sensor of each type, with the errors stated in its settings.
class OwnLocalization {
 public:
  /// @param known_start the pose of the first step is known; otherwise the robot is lost until a positioning system or
  /// its GPS receiver finds it  @param monitored sensors that become faulty are not used (the shell's `monitor`)
  /// @throws base::InputError for a robot without encoders, with invalid settings of these sensors, and with nothing to
  /// compare them with
  explicit OwnLocalization(const world::Mover& mover, bool known_start = true, bool monitored = false);

  /// Returns `input` with the estimate as the robot's pose and twist, and as the poses of its readings at their times.
  /// While the robot is lost, returns `input` unchanged. Spans are valid until the next call.
  ControllerInput localize(const ControllerInput& input);

  /// Returns the estimate at the last step, which the robot broadcasts, and its quality.
  const base::Report& state() const { return state_; }
  const base::StateQuality& quality() const { return quality_; }
  /// Returns whether the last step found no pose: `state` is not valid, and the robot broadcasts nothing.
  bool is_lost() const { return quality_.age == base::kNoStateYet; }
  /// [ns] within the last second, or later. @pre after a step that was not lost; z is 0
  base::Pose pose_at(std::int64_t time) const { return predict(time).estimate.X_WM; }
  /// Returns the monitor of the robot's sensors; null without one, and before the first step.
  const estimation::LocalizationMonitor* monitor() const {
    return filter_ ? std::get_if<estimation::LocalizationMonitor>(&*filter_) : nullptr;
  }
  /// Returns the error relative to the poses of the inputs.
  const LocalizationError& error() const { return error_; }

 private:
  using Filter = std::variant<estimation::Localization, estimation::LocalizationMonitor>;
  estimation::Prediction predict(std::int64_t time) const;
  void add_pose(std::int64_t time, const base::Pose& X_WM, const std::array<double, 6>& covariance);
  void take(const base::ReadingBlock& reading);

  Filter first_;
  bool known_start_;
  std::optional<Filter> filter_;        ///< `first_`, from the first step on
  std::array<std::int64_t, 256> last_;  ///< [ns] by sensor type: time of the last reading
  std::vector<base::ReadingBlock> readings_;
  base::Report state_;
  base::StateQuality quality_;  ///< not stated before the first step
  LocalizationError error_;
};

/// Returns the localization of a controller created by `make_controller`; null if the controller does not use it.
const OwnLocalization* localization_of(const Controller& controller);

}  // namespace sf::control
