#pragma once
// Odometry: where a robot is by its own account.
//
//   Odometer odometer(mover, source);
//   odometer.begin();                                     // of a run
//   if (odometer.has_encoders()) odometer.roll(reading);  // each reading of its encoders
//   else odometer.move(time, X_WM, velocity);             // each tick
//
// The covariance of wheel odometry has two parts; docs/bridges.md gives the formulas.
//
// Slip: the variance slip^2 |d| of a wheel that rolled d. The usual propagation to first order (Siegwart and
// Nourbakhsh, Introduction to Autonomous Mobile Robots, 5.2.4) fails once the heading is off by some tenths of a
// radian: it states far too little along a straight way, which such a heading shortens. Deviation: the mean squares
// here are exact, as those of e^(i error) are for a normal error of the heading.
//
// Rounding to counts: at most half a count of each wheel's whole way, which does not add up. But it turns the heading,
// which displaces each step sideways. While the wheels count the same in each step, as at constant speed, this is the
// same error from step to step; else another one.

#include <array>
#include <complex>
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
  /// Mean values of the error D of the position, as a complex number x + iy [m], with the error e [rad] of the heading
  /// by slip, and with that by rounding.
  struct Errors {
    using Complex = std::complex<double>;
    Complex position;      ///< of D
    Complex square;        ///< of D^2
    Complex turned;        ///< of D exp(ie)
    Complex back;          ///< of D exp(-ie)
    Complex with_yaw;      ///< of D e
    Complex with_rounded;  ///< of D and the rounding of the heading
    double norm = 0.0;     ///< of |D|^2
    double yaw = 0.0;      ///< of e^2
  };

  void propagate(double left, double right, double middle);
  void add_slip(double left, double right, double way, Errors::Complex along);
  void add_rounding(double left, double right, Errors::Complex step);
  void state_covariance(double left, double right, double seconds);

  std::optional<EncoderInfo> encoder_;
  bool truth_;
  bool away_ = false;
  double max_forward_;  ///< [m/s]
  OdometryState state_;
  Errors errors_;                    ///< without the rounding of the last counts
  double left_ = 0.0, right_ = 0.0;  ///< [m] rolled at the last reading
  std::array<double, 2> counted_{};  ///< by both wheels, in the last step that counted
};

}  // namespace sf::record
