#pragma once
// Odometry: where a robot is by its own account.
//
//   Odometer odometer(mover, source);
//   odometer.begin();                                     // of a run
//   if (odometer.has_encoders()) odometer.roll(reading);  // each reading of its encoders
//   else odometer.move(time, X_WM, velocity);             // each tick
//
// The covariance of wheel odometry is propagated to first order (Siegwart and Nourbakhsh, Introduction to Autonomous
// Mobile Robots, 5.2.4), with the variance slip^2 |d| of a wheel that rolled d. Rounding to counts does not add up
// along the way, as each count is of the whole way, except that a heading that is off displaces each step sideways.

#include <array>
#include <cstdint>
#include <optional>

#include "base/pose.h"
#include "base/reading.h"
#include "record/run_info.h"
#include "record/topic_names.h"

namespace sf::record {

/// As in nav_msgs/Odometry, of a robot in the plane. All zero: not stated.
struct OdometryCovariance {
  std::array<double, 6> pose{};   ///< of x, y [m], yaw [rad] in the parent's frame: xx, xy, x yaw, yy, y yaw, yaw yaw
  std::array<double, 3> twist{};  ///< of forward [m/s] and turn [rad/s]: both, and in the middle their covariance
  double fixed = 0.0;             ///< variance of components that a robot in the plane does not change
};

/// Variance of quantities without an error: filters cannot invert zero.
inline constexpr double kLeastVariance = 1e-9;

struct OdometryState {
  std::int64_t time = -1;  ///< [ns] of the measurement; -1: none came yet
  base::Pose X_OM;         ///< the robot in the odometry's frame
  base::Pose X_WO;         ///< the odometry's frame in the world: it drifts by the odometry's errors
  base::Twist velocity;    ///< in the robot's frame
  OdometryCovariance covariance;
};

class Odometer {
 public:
  /// @param source `encoders`: of those that the mover has
  Odometer(const MoverInfo& mover, OdometrySource source);

  /// Forgets all: the next pose or reading is the first one of a run.
  void begin();
  bool has_encoders() const { return encoder_.has_value(); }
  /// The readings of these encoders.
  bool reads(const base::ReadingBlock& reading) const {
    return encoder_ && reading.type == encoder_->type && reading.sensor == 0;
  }

  /// The true pose, or its estimate with a quality. As encoders do not count it, a displacement of more than 0.5 m plus
  /// twice the distance possible at top speed moves the odometry's frame instead.
  void move(std::int64_t time, const base::Pose& X_WM, const base::Twist& velocity,
            const base::StateQuality& quality = {});
  /// A reading of the encoders. @return false: it is earlier than the last one, which may come twice, and left out
  bool roll(const base::ReadingBlock& encoder);
  /// The mover is out of the world, and may return elsewhere.
  void leave() { away_ = true; }
  const OdometryState& state() const { return state_; }

 private:
  void propagate(double left, double right, double middle);
  void state_covariance(double left, double right, double seconds);

  std::optional<EncoderInfo> encoder_;
  bool truth_;
  bool away_ = false;
  double max_forward_;  ///< [m/s]
  OdometryState state_;
  std::array<double, 6> walked_{};   ///< covariance of the pose, without the rounding of the last counts
  double left_ = 0.0, right_ = 0.0;  ///< [m] rolled at the last reading
};

}  // namespace sf::record
