#pragma once
// A simulated robot with two driven wheels and the errors of its own sensors, in double.

#include <cmath>
#include <random>

#include "robots/estimation/localization.h"
#include "robots/kinematics.h"
#include "tests/units.h"

namespace sf::estimation::reference {

/// The true constants and errors of the robot's sensors.
struct DrivenRobot {
  double left_scale = 1.0, right_scale = 1.0;  ///< metres counted per metre rolled
  double track = 0.258;                        ///< [m] effective
  double slip = 0.005;                         ///< [m^(1/2)]
  double per_count = 1e-3;                     ///< [m]
  double gyro_bias = 0.0;                      ///< [rad/s]
  double gyro_scale = 1.0;                     ///< [-]
  double camera_sigma = 0.005;                 ///< [m]
  double camera_yaw_sigma = 0.01;              ///< [rad]
  std::mt19937_64 random{1};

  base::Pose X_WM;
  base::Twist velocity;
  std::int64_t time = 0;
  double left = 0.0, right = 0.0;  ///< [m] counted

  double normal(double sigma) { return sigma * std::normal_distribution<double>{}(random); }

  void drive(const base::Twist& twist, std::int64_t duration) {
    const double dt = 1e-9 * static_cast<double>(duration);
    velocity = twist;
    X_WM = robots::advance(X_WM, twist, dt);
    const double l = (twist.forward - 0.5 * track * twist.turn) * dt,
                 r = (twist.forward + 0.5 * track * twist.turn) * dt;
    left += left_scale * l + normal(slip * std::sqrt(std::abs(l)));
    right += right_scale * r + normal(slip * std::sqrt(std::abs(r)));
    time += duration;
  }

  double counted(double rolled) const { return per_count * std::round(rolled / per_count); }
  Verdict add_encoder(Localization& to) const { return to.add_encoder(time, counted(left), counted(right)); }
  Verdict add_gyro(Localization& to) {
    return to.add_gyro(time, gyro_scale * velocity.turn + gyro_bias + normal(1.7e-3));
  }

  std::array<double, 6> camera_covariance() const {
    const double position = camera_sigma * camera_sigma;
    return {position, 0.0, 0.0, position, 0.0, camera_yaw_sigma * camera_yaw_sigma};
  }
  base::Pose seen() {
    return {X_WM.x + normal(camera_sigma), X_WM.y + normal(camera_sigma), 0.0, X_WM.yaw + normal(camera_yaw_sigma)};
  }
  Verdict add_camera(Localization& to) { return to.add_pose(time, seen(), camera_covariance()); }

  double error(const Localization& of) const {
    const base::Pose estimated = of.predict(time).estimate.X_WM;
    return std::hypot(estimated.x - X_WM.x, estimated.y - X_WM.y);
  }
};

}  // namespace sf::estimation::reference
