#pragma once
// A simulated object with the noise of a motion model, its measurements, and the errors of its estimates.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "robots/estimation/kalman.h"
#include "tests/robots/estimation/reference.h"

namespace sf::estimation::reference {

/// Variances of measurements.
struct Variances {
  double position = 4e-4, yaw = 1e-4, speed = 1e-3, turn = 4e-3;
};

/// The true state, integrated in small steps of its own equations.
struct Truth {
  Vector s{};
  std::mt19937_64& random;

  std::normal_distribution<double> standard;

  double normal(double variance) { return std::sqrt(variance) * standard(random); }

  void move(const MotionModel& model, double seconds) {
    constexpr int kParts = 8;
    const double h = seconds / kParts;
    for (int k = 0; k < kParts; ++k) {
      // Half of each part's noise is added before the motion and half after it: the midpoint rule.
      const Vector noise{normal(model.slip * h),    normal(model.slip * h), 0.0,
                         normal(model.forward * h), normal(model.left * h), normal(model.turn * h)};
      for (int i = 0; i < 6; ++i) s[i] += 0.5 * noise[i];
      const Vector first = rate(model.path, s);
      Vector middle = s;
      for (int i = 0; i < 6; ++i) middle[i] += 0.5 * h * first[i];
      const Vector d = rate(model.path, middle);
      for (int i = 0; i < 6; ++i) s[i] += h * d[i] + 0.5 * noise[i];
    }
  }

  Measurement measure(std::uint8_t components, std::int64_t time, const Variances& v = {}) {
    Measurement m{.time = time, .components = components};
    m.pose_covariance = {v.position, 0, 0, v.position, 0, v.yaw};
    m.twist_variance = {v.speed, v.speed, v.turn};
    m.X_WM = {s[kX] + normal(v.position), s[kY] + normal(v.position), 0.0, s[kYaw] + normal(v.yaw)};
    m.velocity = {s[kForward] + normal(v.speed), s[kLeft] + normal(v.speed), s[kTurn] + normal(v.turn)};
    return m;
  }
};

/// Normalised estimation error squared. Components that are certain are left out.
inline double nees(const Estimate& e, const Vector& truth, int& degrees) {
  const Vector estimated = state_of(e);
  Matrix P = covariance_of(e);
  Vector error{};
  degrees = 0;
  for (int i = 0; i < 6; ++i) {
    error[i] = i == kYaw ? base::wrap_angle(estimated[i] - truth[i]) : estimated[i] - truth[i];
    if (P[i][i] == 0.0) {
      P[i][i] = 1.0;
      EXPECT_EQ(error[i], 0.0);
    } else {
      ++degrees;
    }
  }
  const Matrix information = inverse(P);
  double sum = 0.0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) sum += error[i] * information[i][j] * error[j];
  return sum;
}

}  // namespace sf::estimation::reference
