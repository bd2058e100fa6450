#pragma once
// The two steps of an extended Kalman filter of a planar object. Both are functions of their arguments alone and
// allocate nothing.
//
// Reference: Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001:
// discretisation 4.7.1, Joseph form 5.2.3, consistency tests 5.4.2, coordinated turn 11.7.

#include <array>
#include <cstdint>

#include "robots/estimation/state.h"

namespace sf::estimation {

/// Motion without noise, and the spectral densities of white noise: of accelerations, and of the position's speed.
struct MotionModel {
  enum class Path : std::uint8_t {
    arc,      ///< constant twist in the object's frame, as robots::advance: wheels
    inertial  ///< constant velocity in the world and constant turn rate: a body that slides or is carried
  };
  Path path = Path::arc;
  double forward = 0.1;  ///< [m^2/s^3] >= 0
  double left = 0.0;     ///< [m^2/s^3] >= 0; on an arc 0 also means that the object cannot move sideways
  double turn = 1.0;     ///< [rad^2/s^3] >= 0
  double slip = 1e-5;    ///< [m^2/s] >= 0, random walk of the position. At 0 the sideways variance of a robot at rest
                         ///< falls to 0, and the gate then refuses whatever moves it
  /// Standard deviations of what the first measurement leaves open: yaw [rad], speed [m/s], turn rate [rad/s].
  std::array<double, 3> unknown{M_PI, 1.0, 1.0};
};

/// Differential drive (also skid and car): no sideways motion. A density q lets a speed wander by sqrt(q t) in t.
constexpr MotionModel differential_drive(double forward = 0.1, double turn = 1.0) {
  return {MotionModel::Path::arc, forward, 0.0, turn};
}
/// Any planar body.
constexpr MotionModel free_body(double linear = 0.1, double turn = 1.0) {
  return {MotionModel::Path::inertial, linear, linear, turn};
}

/// The estimate at `time`, later or earlier; its covariance grows by the noise of the time between. The path is exact.
/// The noise is integrated along it (Gauss-Legendre, three points): exact for straight paths, and to 1 % for turns of
/// up to one radian.
Estimate predict(const MotionModel& model, const Estimate& estimate, std::int64_t time);

/// The first estimate of an object. Without a yaw it is a single wide Gaussian, which is right until the object moves
/// (hypotheses.h: beyond that). @param measurement valid, with x and y
Estimate first_estimate(const MotionModel& model, const Measurement& measurement);

struct Innovation {
  double squared = 0.0;  ///< normalised innovation squared (NIS): chi-square distributed where the model is true
  int degrees = 0;       ///< of freedom: measured components, 1 to 6
  double log_determinant = 0.0;  ///< of the difference's covariance
};

/// The difference between a valid measurement and an estimate at its time, in units of its standard deviation.
Innovation innovation(const Estimate& predicted, const Measurement& measurement);

/// Applies a valid measurement to an estimate at its time, in Joseph's form. Yaw differences are wrapped.
Estimate correct(const Estimate& predicted, const Measurement& measurement);

}  // namespace sf::estimation
