#pragma once
// Independent reference for the filter's equations in plain loops: continuous time, integrated in small steps, and the
// update in information form. Uses no code of the filter.

#include <array>
#include <cmath>
#include <utility>

#include "robots/estimation/kalman.h"

namespace sf::estimation::reference {

using Vector = std::array<double, 6>;
using Matrix = std::array<Vector, 6>;

inline Vector state_of(const Estimate& e) {
  return {e.X_WM.x, e.X_WM.y, e.X_WM.yaw, e.velocity.forward, e.velocity.left, e.velocity.turn};
}

inline Matrix covariance_of(const Estimate& e) {
  Matrix P{};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) P[i][j] = e.covariance[6 * i + j];
  return P;
}

inline Vector rate(MotionModel::Path path, const Vector& s) {
  const double c = std::cos(s[2]), d = std::sin(s[2]);
  const bool inertial = path == MotionModel::Path::inertial;
  return {c * s[3] - d * s[4],          d * s[3] + c * s[4],           s[5],
          inertial ? s[5] * s[4] : 0.0, inertial ? -s[5] * s[3] : 0.0, 0.0};
}

/// Derivative of `rate`.
inline Matrix rate_slope(MotionModel::Path path, const Vector& s) {
  const double c = std::cos(s[2]), d = std::sin(s[2]);
  Matrix A{};
  A[0] = {0, 0, -d * s[3] - c * s[4], c, -d, 0};
  A[1] = {0, 0, c * s[3] - d * s[4], d, c, 0};
  A[2][5] = 1.0;
  if (path == MotionModel::Path::inertial) {
    A[3] = {0, 0, 0, 0, s[5], s[4]};
    A[4] = {0, 0, 0, -s[5], 0, -s[3]};
  }
  return A;
}

struct Both {
  Vector state{};
  Matrix P{};
};

/// x' = f(x), P' = A P + P A^T + Q.
inline Both slope(const MotionModel& model, const Both& b) {
  Both s{rate(model.path, b.state), {}};
  const Matrix A = rate_slope(model.path, b.state);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 6; ++k) s.P[i][j] += A[i][k] * b.P[k][j] + b.P[i][k] * A[j][k];
  s.P[0][0] += model.slip;
  s.P[1][1] += model.slip;
  s.P[3][3] += model.forward;
  s.P[4][4] += model.left;
  s.P[5][5] += model.turn;
  return s;
}

inline Both add(const Both& a, double h, const Both& d) {
  Both sum = a;
  for (int i = 0; i < 6; ++i) {
    sum.state[i] += h * d.state[i];
    for (int j = 0; j < 6; ++j) sum.P[i][j] += h * d.P[i][j];
  }
  return sum;
}

/// Fourth-order Runge-Kutta method. @param seconds > 0
inline Both predict(const MotionModel& model, const Estimate& from, double seconds, int steps = 2000) {
  Both b{state_of(from), covariance_of(from)};
  const double h = seconds / steps;
  for (int k = 0; k < steps; ++k) {
    const Both k1 = slope(model, b), k2 = slope(model, add(b, h / 2, k1)), k3 = slope(model, add(b, h / 2, k2)),
               k4 = slope(model, add(b, h, k3));
    b = add(add(add(add(b, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
  }
  return b;
}

/// Gauss-Jordan elimination with pivoting.
inline Matrix inverse(Matrix A) {
  Matrix B{};
  for (int i = 0; i < 6; ++i) B[i][i] = 1.0;
  for (int i = 0; i < 6; ++i) {
    int pivot = i;
    for (int k = i + 1; k < 6; ++k)
      if (std::abs(A[k][i]) > std::abs(A[pivot][i])) pivot = k;
    std::swap(A[i], A[pivot]);
    std::swap(B[i], B[pivot]);
    const double by = 1.0 / A[i][i];
    for (int j = 0; j < 6; ++j) A[i][j] *= by, B[i][j] *= by;
    for (int k = 0; k < 6; ++k) {
      const double f = A[k][i];
      if (k == i || f == 0.0) continue;
      for (int j = 0; j < 6; ++j) A[k][j] -= f * A[i][j], B[k][j] -= f * B[i][j];
    }
  }
  return B;
}

/// Returns (P^-1 + R^-1)^-1 and its state, for a measurement of all six components without correlations.
inline Both correct(const Estimate& predicted, const Measurement& m) {
  const Vector z{m.X_WM.x, m.X_WM.y, m.X_WM.yaw, m.velocity.forward, m.velocity.left, m.velocity.turn};
  const Vector variance{m.pose_covariance[0], m.pose_covariance[3], m.pose_covariance[5],
                        m.twist_variance[0],  m.twist_variance[1],  m.twist_variance[2]};
  Matrix information = inverse(covariance_of(predicted));
  for (int i = 0; i < 6; ++i) information[i][i] += 1.0 / variance[i];
  Both b{state_of(predicted), inverse(information)};
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k) {
      const double d = z[k] - state_of(predicted)[k];
      b.state[i] += b.P[i][k] / variance[k] * (k == 2 ? std::remainder(d, 2 * M_PI) : d);
    }
  return b;
}

}  // namespace sf::estimation::reference
