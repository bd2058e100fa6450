#pragma once
// Follows a path of the world file: progress, end of the path, and the control loop shared by all followers.

#include <cstdint>
#include <string_view>

#include "base/reading.h"
#include "control/controllers.h"
#include "control/pi_controller.h"
#include "control/stop_reason.h"
#include "world/path_geometry.h"

namespace sf::control {

/// Settings: `stop_before` [m].
class PathTask {
 public:
  /// Selects the path nearest to the robot at load. Without a path the task never ends. @throws base::InputError
  PathTask(const ControllerContext& context, Settings& settings);

  bool known() const { return path_ != nullptr; }
  /// Returns the lane width [m] of the piece nearest to `p`. @pre known()
  double width_at(glm::dvec2 p) const;
  /// Returns whether the robot's origin is within `stop_before` of the path's end, measured along the path.
  bool ended(const base::Pose& X_WM) const;

 private:
  const world::Path* path_ = nullptr;
  double stop_before_ = 0.25;  ///< [m]
};

/// Sample-and-hold for a sensor whose rate differs from the controller's, so that the controller may receive one
/// reading twice, or late.
class SampleHold {
 public:
  explicit SampleHold(double seconds) : hold_(static_cast<std::int64_t>(1e9 * seconds)) {}

  /// @param reading null: none @return true if the newest reading is at most `seconds` old, counted from its arrival
  bool is_fresh(const base::ReadingBlock* reading, std::int64_t time);

  /// @param now value of the reading; NaN: none
  /// @return `now`, or the last value if it is at most `seconds` old, otherwise NaN
  double update(double now, std::int64_t time);

 private:
  std::int64_t hold_;
  std::int64_t last_reading_ = 0, last_value_time_ = 0;  ///< [ns] time of the last new reading, of the last value
  std::uint32_t sequence_ = 0;
  double last_ = std::numeric_limits<double>::quiet_NaN();
  bool any_ = false;
};

/// Follows a path at constant speed, with P or PI steering of an error measured with one sensor. Each step uses the
/// newest reading, whether or not it is new. Without an error the last one is held for `hold` seconds; after that the
/// robot stops until there is one again. The integral is frozen meanwhile. (The thesis does not specify this.)
class PathFollower : public Controller, public StatesStopReason {
 public:
  base::Twist step(const ControllerInput& input) final;
  bool done() const final { return done_; }
  double error() const final { return error_; }
  std::string stop_reason() const final;

 protected:
  /// @param type wire id of the sensor type @param sensor name for messages @param speed [m/s] @param hold [s]
  PathFollower(std::uint8_t type, std::string_view sensor, const PiGains& gains, double speed, double hold,
               const PathTask& task);
  const PathTask& task() const { return task_; }

 private:
  /// Returns the control error from a reading; NaN if the reading contains none.
  virtual double error_of(const base::ReadingBlock& reading, const base::Pose& X_WM) const = 0;

  std::uint8_t type_;
  std::string_view sensor_;
  double speed_;
  PathTask task_;
  PiController pi_;
  SampleHold hold_;
  double error_ = Controller::error();
  bool fresh_ = false;  ///< `SampleHold::is_fresh` at the last step
  bool done_ = false;
};

}  // namespace sf::control
