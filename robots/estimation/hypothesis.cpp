#include "robots/estimation/hypothesis.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::estimation {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

Eigen::Map<const Matrix6> view(const Covariance& P) { return Eigen::Map<const Matrix6>(P.data()); }
Eigen::Map<Matrix6> view(Covariance& P) { return Eigen::Map<Matrix6>(P.data()); }

/// Returns the yaw that rotates velocities into the world frame; 0 on arcs.
double frame(const MotionModel& model, const Estimate& e) {
  return model.path == MotionModel::Path::arc ? 0.0 : e.X_WM.yaw;
}

Vector6 difference(const MotionModel& model, const Estimate& a, const Estimate& b) {
  const glm::dvec2 v = base::rotate(frame(model, a), {a.velocity.forward, a.velocity.left}) -
                       base::rotate(frame(model, b), {b.velocity.forward, b.velocity.left});
  Vector6 d;
  d << a.X_WM.x - b.X_WM.x, a.X_WM.y - b.X_WM.y, base::wrap_angle(a.X_WM.yaw - b.X_WM.yaw), v.x, v.y,
      a.velocity.turn - b.velocity.turn;
  return d;
}

/// Returns the state that differs from `from` by `d`.
Estimate moved(const MotionModel& model, const Estimate& from, const Vector6& d) {
  Estimate e = from;
  e.X_WM.x += d(kX), e.X_WM.y += d(kY);
  e.X_WM.yaw = base::wrap_angle(from.X_WM.yaw + d(kYaw));
  const glm::dvec2 v = base::rotate(frame(model, from), {from.velocity.forward, from.velocity.left});
  const glm::dvec2 turned = base::rotate(-frame(model, e), v + glm::dvec2{d(kForward), d(kLeft)});
  e.velocity = {turned.x, turned.y, from.velocity.turn + d(kTurn)};
  return e;
}

/// Derivatives of a difference with respect to the state, and its inverse.
Matrix6 to_difference(const MotionModel& model, const Estimate& e) {
  Matrix6 H = Matrix6::Identity();
  if (model.path == MotionModel::Path::arc) return H;
  const glm::dvec2 v = base::rotate(e.X_WM.yaw, {e.velocity.forward, e.velocity.left});
  const auto [s, c] = base::sin_cos(e.X_WM.yaw);
  H.block<2, 2>(kForward, kForward) << c, -s, s, c;
  H.block<2, 1>(kForward, kYaw) << -v.y, v.x;
  return H;
}
Matrix6 from_difference(const MotionModel& model, const Estimate& e) {
  Matrix6 H = to_difference(model, e);
  if (model.path == MotionModel::Path::arc) return H;
  H.block<2, 2>(kForward, kForward).transposeInPlace();
  H.block<2, 1>(kForward, kYaw) << e.velocity.left, -e.velocity.forward;
  return H;
}

void store_symmetric(const Matrix6& P, Estimate& e) { view(e.covariance) = 0.5 * (P + P.transpose()); }

}  // namespace

double middle_heading_sigma(const Estimate& estimate, double dt) {
  const auto P = view(estimate.covariance);
  return std::sqrt(std::max(0.0, P(kYaw, kYaw) + dt * P(kYaw, kTurn) + 0.25 * dt * dt * P(kTurn, kTurn)));
}

// Splits along the direction in which the heading changes: DeMars, Bishop and Jah, Entropy-based approach for
// uncertainty propagation, J. Guidance 36, 2013, but with equally spaced parts instead of fitted ones.
void split(const MotionModel& model, const Hypothesis& whole, double dt, double narrow,
           std::vector<Hypothesis>& parts) {
  const Matrix6 H = to_difference(model, whole.estimate);
  const Matrix6 P = H * view(whole.estimate.covariance) * H.transpose();
  const Vector6 Pa = P.col(kYaw) + 0.5 * dt * P.col(kTurn);
  const double variance = Pa(kYaw) + 0.5 * dt * Pa(kTurn);
  const double apart = 1.75 * narrow, rest = variance - narrow * narrow;
  const auto density = [&](int k) { return base::exp(-0.5 * apart * apart * k * k / rest); };

  // Wider headings are split again in the next step.
  const int most = static_cast<int>(std::clamp(2.5 * std::sqrt(rest) / apart, 1.0, 4.0));
  double total = 1.0, spread = 0.0;
  for (int k = 1; k <= most; ++k) total += 2.0 * density(k), spread += 2.0 * density(k) * apart * apart * k * k;
  const Matrix6 P_part = P - Pa * Pa.transpose() * (spread / total / (variance * variance));
  for (int k = 0; k <= 2 * most; ++k) {
    const int place = k % 2 == 0 ? -k / 2 : (k + 1) / 2;  // 0, 1, -1, 2, -2 ...
    Hypothesis part{whole.weight * density(place) / total,
                    moved(model, whole.estimate, Pa * (place * apart / variance))};
    const Matrix6 back = from_difference(model, part.estimate);
    store_symmetric(back * P_part * back.transpose(), part.estimate);
    parts.push_back(part);
  }
}

Hypothesis merged(const MotionModel& model, std::span<const Hypothesis> parts) {
  if (parts.size() == 1) return parts[0];
  const Estimate& first = parts[0].estimate;
  double weight = 0.0;
  Vector6 sum = Vector6::Zero();
  Matrix6 squares = Matrix6::Zero();
  for (const auto& [w, e] : parts) {
    const Vector6 d = difference(model, e, first);
    const Matrix6 H = to_difference(model, e);
    weight += w;
    sum += w * d;
    squares += w * (H * view(e.covariance) * H.transpose() + d * d.transpose());
  }
  const Vector6 mean = sum / weight;
  Hypothesis whole{weight, moved(model, first, mean)};
  const Matrix6 back = from_difference(model, whole.estimate);
  store_symmetric(back * (squares / weight - mean * mean.transpose()) * back.transpose(), whole.estimate);
  return whole;
}

Estimate correct(const MotionModel& model, const Estimate& predicted, const Measurement& m) {
  const Estimate corrected = correct(predicted, m);
  const bool velocity = (m.components & (1u << kForward | 1u << kLeft)) != 0;
  if (model.path == MotionModel::Path::arc || velocity) return corrected;
  const Matrix6 H = to_difference(model, predicted);
  Estimate e = moved(model, predicted, H * difference({}, corrected, predicted));
  e.X_WM.z = corrected.X_WM.z;
  const Matrix6 J = from_difference(model, e) * H;
  store_symmetric(J * view(corrected.covariance) * J.transpose(), e);
  return e;
}

void add_square_error(const Estimate& state, const Hypothesis& truth, Covariance& sum) {
  const auto P = view(truth.estimate.covariance);
  const Vector6 d = difference({}, truth.estimate, state);
  Matrix6 S = P + d * d.transpose();
  // Yaw errors beyond half a turn wrap to the other side: uses the moments of the tail of a Gaussian.
  if (const double sigma = std::sqrt(P(kYaw, kYaw)); sigma > 0.0) {
    const double z = (M_PI - std::abs(d(kYaw))) / sigma;
    const double beyond = 0.5 * base::erfc(z / std::sqrt(2.0));
    const double density = base::exp(-0.5 * z * z) / std::sqrt(2.0 * M_PI);
    const Vector6 less = -2.0 * M_PI * (std::copysign(beyond, d(kYaw)) * d + density / sigma * P.col(kYaw));
    S.row(kYaw) += less.transpose();
    S.col(kYaw) += less;
    S(kYaw, kYaw) += 4.0 * M_PI * M_PI * beyond;
  }
  view(sum) += truth.weight * S;
}

}  // namespace sf::estimation
