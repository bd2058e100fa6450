#include "robots/estimation/kalman.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>

#include "base/elementary.h"
#include "robots/estimation/planar_motion.h"

namespace sf::estimation {

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Columns3 = Eigen::Matrix<double, 6, 3>;
// One row or column per measured component, on the stack.
using MeasuredVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
using MeasuredMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

Eigen::Map<const Matrix6> matrix(const Covariance& covariance) { return Eigen::Map<const Matrix6>(covariance.data()); }

/// Stores the symmetric part, to remove rounding errors.
void store(const Matrix6& P, Covariance& covariance) {
  Eigen::Map<Matrix6>(covariance.data()) = 0.5 * (P + P.transpose());
}

/// Covariance added by white accelerations over dt: the integral of F G q G^T F^T, where F propagates from the time of
/// the noise to the end.
Matrix6 process_noise(const MotionModel& model, const Motion& from, double dt) {
  const Eigen::Vector3d density(model.forward, model.left, model.turn);
  Matrix6 Q = Matrix6::Zero();
  Q(kX, kX) = Q(kY, kY) = model.slip * std::abs(dt);
  for (const auto& [place, weight] : kGaussLegendre) {
    const Motion then = move(model.path, from, place * dt);
    const Columns3 G = matrix(jacobian(model.path, then, (1.0 - place) * dt)).rightCols<3>();
    Q += weight * std::abs(dt) * G * density.asDiagonal() * G.transpose();
  }
  return Q;
}

/// The rows of H, which are rows of the identity matrix.
struct Measured {
  std::array<int, 6> component{};
  int count = 0;
};

Measured measured_components(const Measurement& m) {
  Measured measured;
  for (int k = 0; k < 6; ++k)
    if ((m.components >> k & 1u) != 0) measured.component[measured.count++] = k;
  return measured;
}

Matrix6 noise(const Measurement& m) {
  const auto& c = m.pose_covariance;
  Matrix6 R = Matrix6::Zero();
  R.topLeftCorner<3, 3>() << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  R.diagonal().tail<3>() << m.twist_variance[0], m.twist_variance[1], m.twist_variance[2];
  return R;
}

Eigen::Matrix<double, 6, 1> difference(const Measurement& m, const Estimate& e) {
  const base::Pose &z = m.X_WM, &x = e.X_WM;
  Eigen::Matrix<double, 6, 1> d;
  d << z.x - x.x, z.y - x.y, base::wrap_angle(z.yaw - x.yaw), m.velocity.forward - e.velocity.forward,
      m.velocity.left - e.velocity.left, m.velocity.turn - e.velocity.turn;
  return d;
}

MeasuredMatrix select_block(const Matrix6& A, const Measured& measured) {
  MeasuredMatrix selected(measured.count, measured.count);
  for (int i = 0; i < measured.count; ++i)
    for (int j = 0; j < measured.count; ++j) selected(i, j) = A(measured.component[i], measured.component[j]);
  return selected;
}

MeasuredVector select_rows(const Eigen::Matrix<double, 6, 1>& v, const Measured& measured) {
  MeasuredVector selected(measured.count);
  for (int i = 0; i < measured.count; ++i) selected(i) = v(measured.component[i]);
  return selected;
}

}  // namespace

Estimate predict(const MotionModel& model, const Estimate& estimate, std::int64_t time) {
  if (time == estimate.time) return estimate;
  const double dt = 1e-9 * static_cast<double>(time - estimate.time);
  const Motion from{estimate.X_WM, estimate.velocity};
  const Motion to = move(model.path, from, dt);
  const Matrix6 F = matrix(jacobian(model.path, from, dt));
  Estimate later{time, to.X_WM, to.velocity};
  store(F * matrix(estimate.covariance) * F.transpose() + process_noise(model, from, dt), later.covariance);
  return later;
}

Estimate first_estimate(const MotionModel& model, const Measurement& measurement) {
  const auto is_measured = [&](int k) { return (measurement.components >> k & 1u) != 0; };
  const bool straight = model.path == MotionModel::Path::arc && model.left == 0.0;
  const std::array<double, 6> unknown{0.0, 0.0, model.unknown[0], model.unknown[1], model.unknown[1], model.unknown[2]};
  Matrix6 P = noise(measurement);
  for (int k = 0; k < 6; ++k) {
    if (is_measured(k)) continue;
    P.row(k).setZero();
    P.col(k).setZero();
    P(k, k) = unknown[k] * unknown[k];
  }
  Estimate estimate{measurement.time, measurement.X_WM, measurement.velocity};
  estimate.X_WM.yaw = is_measured(kYaw) ? base::wrap_angle(measurement.X_WM.yaw) : 0.0;
  if (!is_measured(kForward)) estimate.velocity.forward = 0.0;
  if (!is_measured(kLeft) || straight) estimate.velocity.left = 0.0;
  if (!is_measured(kTurn)) estimate.velocity.turn = 0.0;
  if (straight) P(kLeft, kLeft) = 0.0;
  store(P, estimate.covariance);
  return estimate;
}

Innovation innovation(const Estimate& predicted, const Measurement& measurement) {
  const Measured measured = measured_components(measurement);
  const MeasuredMatrix S = select_block(matrix(predicted.covariance) + noise(measurement), measured);
  const MeasuredVector y = select_rows(difference(measurement, predicted), measured);
  const Eigen::LLT<MeasuredMatrix> llt(S);
  return {y.dot(llt.solve(y)), measured.count, 2.0 * llt.matrixLLT().diagonal().unaryExpr(&base::log).sum()};
}

Estimate correct(const Estimate& predicted, const Measurement& measurement) {
  const Measured measured = measured_components(measurement);
  const auto P = matrix(predicted.covariance);
  const Matrix6 R = noise(measurement);
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> PHt(6, measured.count);
  for (int i = 0; i < measured.count; ++i) PHt.col(i) = P.col(measured.component[i]);

  // K = P H^T S^-1, and K H expanded to all columns.
  const MeasuredMatrix S = select_block(P + R, measured);
  const Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 6, 6> Kt = S.llt().solve(PHt.transpose());
  Matrix6 KH = Matrix6::Zero();
  for (int i = 0; i < measured.count; ++i) KH.col(measured.component[i]) = Kt.row(i).transpose();
  const Eigen::Matrix<double, 6, 1> step = Kt.transpose() * select_rows(difference(measurement, predicted), measured);

  Estimate estimate = predicted;
  base::Pose& X = estimate.X_WM;
  X = {X.x + step(kX), X.y + step(kY), (measurement.components & kPositionBits) != 0 ? measurement.X_WM.z : X.z,
       base::wrap_angle(X.yaw + step(kYaw))};
  estimate.velocity.forward += step(kForward);
  estimate.velocity.left += step(kLeft);
  estimate.velocity.turn += step(kTurn);
  const Matrix6 rest = Matrix6::Identity() - KH;
  store(rest * P * rest.transpose() + KH * R * KH.transpose(), estimate.covariance);
  return estimate;
}

}  // namespace sf::estimation
