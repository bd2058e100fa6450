#pragma once
// Odometry: the pose of a robot according to its own measurements.
//
//   Odometer odometer(mover, source);
//   odometer.begin();                                     // of a run
//   if (odometer.has_encoders()) odometer.roll(reading);  // each reading of its encoders
//   else odometer.move(time, X_WM, velocity);             // each tick
//
// The covariance of wheel odometry has two parts; docs/bridges.md gives the formulas.
//
// Slip: a wheel that rolls d has the variance slip^2 |d|. The usual first-order propagation (Siegwart and Nourbakhsh,
// Introduction to Autonomous Mobile Robots, 5.2.4) fails once the heading error reaches some tenths of a radian: it
// greatly underestimates the error along a straight path, because such a heading error shortens the path. Deviation:
// the mean squares here are exact for a normal error of the heading, as they use those of e^(i error).
//
// Rounding to counts: the error is at most half a count of each wheel's total distance and does not accumulate.
// However, it turns the heading, which displaces each step sideways. While the wheels count the same number in each
// step, as at constant speed, the error is the same from step to step; otherwise it differs.

#include <array>
#include <complex>
#include <cstdint>
#include <optional>

#include "base/pose.h"
#include "base/reading.h"
#include "record/run_info.h"
#include "record/topic_names.h"

namespace sf::record {

/// Covariance of nav_msgs/Odometry, for a robot in the plane. All zero: not stated.
struct OdometryCovariance {
  std::array<double, 6> pose{};   ///< covariance of x, y [m], yaw [rad] in the parent's frame: xx, xy, x yaw, yy, y
                                  ///< yaw, yaw yaw
  std::array<double, 3> twist{};  ///< covariance of forward [m/s] and turn [rad/s]: the two variances, with their
                                  ///< covariance in between
  double fixed = 0.0;             ///< variance of components that a robot in the plane does not change
};

/// Variance of quantities without an error, because filters cannot invert zero.
inline constexpr double kLeastVariance = 1e-9;

struct OdometryState {
  std::int64_t time = -1;  ///< [ns] time of the measurement; -1: no measurement yet
  base::Pose X_OM;         ///< pose of the robot in the odometry's frame
  base::Pose X_WO;         ///< pose of the odometry's frame in the world, which drifts by the odometry's errors
  base::Twist velocity;    ///< in the robot's frame
  base::Tilt tilt;         ///< true: encoders do not measure it
  OdometryCovariance covariance;
};

class Odometer {
 public:
  /// @param source `encoders`: uses the encoders that the mover has
  Odometer(const MoverInfo& mover, OdometrySource source);

  /// Resets the state: the next pose or reading is the first one of a run.
  void begin();
  bool has_encoders() const { return encoder_.has_value(); }
  /// Returns whether the reading is from these encoders.
  bool reads(const base::ReadingBlock& reading) const {
    return encoder_ && reading.type == encoder_->type && reading.sensor == 0;
  }

  /// Updates the state from the true pose, or from its estimate with a quality. A displacement of more than 0.5 m plus
  /// twice the distance possible at top speed moves the odometry's frame instead, because encoders do not count it.
  void move(std::int64_t time, const base::Pose& X_WM, const base::Twist& velocity,
            const base::StateQuality& quality = {}, const base::Tilt& tilt = {});
  /// Updates the state from a reading of the encoders. @return false if it is earlier than the last one, which may
  /// arrive twice; it is then ignored
  bool roll(const base::ReadingBlock& encoder);
  /// Notes that the mover has left the world. It may return at another place.
  void leave() { away_ = true; }
  const OdometryState& state() const { return state_; }

 private:
  /// Mean values of the error D of the position, as a complex number x + iy [m], with the error e [rad] of the heading
  /// caused by slip, and with the error caused by rounding.
  struct Errors {
    using Complex = std::complex<double>;
    Complex position;      ///< mean of D
    Complex square;        ///< mean of D^2
    Complex turned;        ///< mean of D exp(ie)
    Complex back;          ///< mean of D exp(-ie)
    Complex with_yaw;      ///< mean of D e
    Complex with_rounded;  ///< mean of D times the rounding of the heading
    double norm = 0.0;     ///< mean of |D|^2
    double yaw = 0.0;      ///< mean of e^2
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
  std::array<double, 2> counted_{};  ///< counts of both wheels, in the last step with counts
};

}  // namespace sf::record
