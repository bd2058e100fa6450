#pragma once
// The prediction and correction steps of an extended Kalman filter for a planar object. Both are pure functions and do
// not allocate.
//
// Reference: Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001:
// discretisation 4.7.1, Joseph form 5.2.3, consistency tests 5.4.2, coordinated turn 11.7.

#include <array>
#include <cstdint>

#include "robots/estimation/state.h"

namespace sf::estimation {

/// Noise-free motion, and the spectral densities of the white noise of the accelerations and of the position's rate.
struct MotionModel {
  enum class Path : std::uint8_t {
    arc,      ///< constant twist in the object's frame, as in robots::advance: wheeled robots
    inertial  ///< constant velocity in the world frame and constant turn rate: a body that slides or is carried
  };
  Path path = Path::arc;
  double forward = 0.1;  ///< [m^2/s^3] >= 0
  double left = 0.0;     ///< [m^2/s^3] >= 0; on an arc, 0 also means that the object cannot move sideways
  double turn = 1.0;     ///< [rad^2/s^3] >= 0
  double slip = 1e-5;  ///< [m^2/s] >= 0, random walk of the position. With 0, the sideways variance of a robot at rest
                       ///< falls to 0, and the gate then rejects any sideways motion
  /// Standard deviations of components missing from the first measurement: yaw [rad], speed [m/s], turn rate [rad/s].
  std::array<double, 3> unknown{M_PI, 1.0, 1.0};
};

/// Differential drive (also skid and car): no sideways motion. With density q, a speed drifts by sqrt(q t) in time t.
constexpr MotionModel differential_drive(double forward = 0.1, double turn = 1.0) {
  return {MotionModel::Path::arc, forward, 0.0, turn};
}
/// Any planar body.
constexpr MotionModel free_body(double linear = 0.1, double turn = 1.0) {
  return {MotionModel::Path::inertial, linear, linear, turn};
}

/// Returns the estimate at `time`, earlier or later. The covariance grows by the noise of the elapsed time. The path is
/// exact. The noise is integrated along it (three-point Gauss-Legendre): exact for straight paths, and to 1 % for turns
/// of up to one radian.
Estimate predict(const MotionModel& model, const Estimate& estimate, std::int64_t time);

/// Returns the first estimate of an object. Without a yaw it is a single wide Gaussian, which is accurate only until
/// the object moves (see hypotheses.h).
/// @param measurement valid, with x and y
Estimate first_estimate(const MotionModel& model, const Measurement& measurement);

struct Innovation {
  double squared = 0.0;  ///< normalised innovation squared (NIS): chi-square distributed if the model is correct
  int degrees = 0;       ///< degrees of freedom: number of measured components, 1 to 6
  double log_determinant = 0.0;  ///< of the covariance of the innovation
};

/// Returns the difference between a valid measurement and an estimate at the same time, in standard deviations.
Innovation innovation(const Estimate& predicted, const Measurement& measurement);

/// Applies a valid measurement to an estimate at the same time, in Joseph form. Yaw differences are wrapped.
Estimate correct(const Estimate& predicted, const Measurement& measurement);

}  // namespace sf::estimation
