#pragma once
// Following a path of the world: which piece one is on, when one is through, and the loop that all who follow share.

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
  /// The path is the world's nearest to the robot at load; there need not be one: then it never ends.
  /// @throws base::InputError
  PathTask(const ControllerContext& context, Settings& settings);

  bool known() const { return path_ != nullptr; }
  /// [m] lane width of the piece nearest to `p`. Rule: known().
  double width_at(glm::dvec2 p) const;
  /// The robot's origin has come as far along the path as `stop_before` its end.
  bool ended(const base::Pose& X_WM) const;

 private:
  const world::Path* path_ = nullptr;
  double stop_before_ = 0.25;  ///< [m]
};

/// The last reading of a sensor, and whether there still are new ones: for controllers that run at a rate of their own
/// and meet readings twice, or late.
class SampleHold {
 public:
  explicit SampleHold(double seconds) : hold_(static_cast<std::int64_t>(1e9 * seconds)) {}

  /// @param reading null: none
  /// @return whether the sensor still speaks: nothing new for longer than `seconds` is silence
  bool is_fresh(const base::ReadingBlock* reading, std::int64_t time);

  /// @param now what the reading says; not a number: nothing
  /// @return `now`, or what it was last within `seconds`, or not a number
  double update(double now, std::int64_t time);

 private:
  std::int64_t hold_;
  std::int64_t last_reading_ = 0, last_value_time_ = 0;  ///< [ns] of the last new reading, of the last number
  std::uint32_t sequence_ = 0;
  double last_ = std::numeric_limits<double>::quiet_NaN();
  bool any_ = false;
};

/// Follows a path at constant speed by what one sensor says of the error, with P or PI steering: readings are taken at
/// its own rate, new or not. Without an error it goes on with the last for `hold` seconds, then stands until there is
/// one again; the integral rests meanwhile. (The thesis says nothing of it.)
class PathFollower : public Controller, public StatesStopReason {
 public:
  base::Twist step(const ControllerInput& input) final;
  bool done() const final { return done_; }
  double error() const final { return error_; }
  std::string stop_reason() const final;

 protected:
  /// @param kind of the sensor @param sensor its name, for people @param speed [m/s] @param hold [s]
  PathFollower(std::uint8_t kind, std::string_view sensor, const PiGains& gains, double speed, double hold,
               const PathTask& task);
  const PathTask& task() const { return task_; }

 private:
  /// Not a number: the reading says nothing.
  virtual double error_of(const base::ReadingBlock& reading, const base::Pose& X_WM) const = 0;

  std::uint8_t kind_;
  std::string_view sensor_;
  double speed_;
  PathTask task_;
  PiController pi_;
  SampleHold hold_;
  double error_ = Controller::error();
  bool fresh_ = false;  ///< the sensor, at the last step
  bool done_ = false;
};

}  // namespace sf::control
