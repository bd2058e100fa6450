#include "robots/estimation/wheeled_state.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>

#include "base/elementary.h"
#include "robots/estimation/planar_motion.h"

namespace sf::estimation {

namespace {

constexpr int kSize = kWheeledComponents;

constexpr int kMoved = kLeftScale;  // the components before are changed by motion, the others are constants
using Vector = Eigen::Matrix<double, kSize, 1>;
using Matrix = Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>;
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using MovedRows = Eigen::Matrix<double, kMoved, kSize, Eigen::RowMajor>;
using MovedMatrix = Eigen::Matrix<double, kMoved, kMoved, Eigen::RowMajor>;

Eigen::Map<const Matrix> covariance_of(const WheeledState& state) {
  return Eigen::Map<const Matrix>(state.covariance.data());
}
Eigen::Map<const Vector> mean_of(const WheeledState& state) { return Eigen::Map<const Vector>(state.mean.data()); }

Motion motion_of(const WheeledState& state) {
  const auto& m = state.mean;
  return {{m[kX], m[kY], state.z, m[kYaw]}, {m[kForward], m[kLeft], m[kTurn]}};
}

/// [m] Speed sideways per turn rate: steady motion of a single-track model, whose rear tyres slip outwards.
double lever_of(const WheeledModel& model, const WheeledState& state) {
  return model.axle - model.sideslip * state.mean[kForward] * state.mean[kForward];
}

/// The motion of the origin. Of the state alone, `left` is without that of turns.
Motion motion_of(const WheeledModel& model, const WheeledState& state) {
  Motion motion = motion_of(state);
  motion.velocity.left += lever_of(model, state) * motion.velocity.turn;
  return motion;
}

/// [m/s] Speeds of the left and the right wheel over ground.
std::array<double, 2> wheel_speeds(const WheeledModel& model, const WheeledState& state) {
  const double half = 0.5 * model.track * state.mean[kTrackScale] * state.mean[kTurn];
  return {state.mean[kForward] - half, state.mean[kForward] + half};
}

/// Returns the rows that differ from the identity of the derivative of the state after `dt` with respect to `state`.
MovedRows derivative(const WheeledModel& model, const WheeledState& state, double dt) {
  MovedRows F = MovedRows::Identity();
  const std::array<double, 36> planar = jacobian(model.motion.path, motion_of(model, state), dt);
  F.topLeftCorner<6, 6>() = Eigen::Map<const Matrix6>(planar.data());
  for (const int k : {kX, kY}) {
    F(k, kForward) -= 2.0 * model.sideslip * state.mean[kForward] * state.mean[kTurn] * F(k, kLeft);
    F(k, kTurn) += lever_of(model, state) * F(k, kLeft);
  }
  const std::array<double, 2> speeds = wheel_speeds(model, state);
  for (const int right : {0, 1}) {
    const double scale = state.mean[kLeftScale + right], half = (right == 0 ? -0.5 : 0.5) * model.track;
    const int row = kLeftRolled + right;
    F(row, kForward) = scale * dt;
    F(row, kTurn) = scale * half * state.mean[kTrackScale] * dt;
    F(row, kTrackScale) = scale * half * state.mean[kTurn] * dt;
    F(row, kLeftScale + right) = speeds[right] * dt;
  }
  return F;
}

WheeledState move(const WheeledModel& model, const WheeledState& from, double dt) {
  WheeledState to = from;
  const Motion moved = estimation::move(model.motion.path, motion_of(model, from), dt);
  const auto& [X, v] = moved;
  const std::array<double, 6> motion{X.x, X.y, X.yaw, v.forward, from.mean[kLeft], v.turn};
  std::copy(motion.begin(), motion.end(), to.mean.begin());
  const std::array<double, 2> speeds = wheel_speeds(model, from);
  for (const int right : {0, 1}) to.mean[kLeftRolled + right] += from.mean[kLeftScale + right] * speeds[right] * dt;
  return to;
}

/// Covariance added by accelerations over dt. @param F derivative after dt
MovedMatrix acceleration_noise(const WheeledModel& model, const WheeledState& from, double dt, const MovedRows& F) {
  const Eigen::Vector3d density(model.motion.forward, model.motion.left, model.motion.turn);
  MovedMatrix Q = MovedMatrix::Zero();
  const auto accelerate = [&](const MovedRows& after, double weight) {
    const Eigen::Matrix<double, kMoved, 3> G = after.middleCols<3>(kForward), weighed = weight * G;
    Q += (weighed * density.asDiagonal()).lazyProduct(G.transpose());
  };
  if (model.steps) accelerate(F, std::abs(dt));
  for (std::size_t k = 0; !model.steps && k < kGaussLegendre.size(); ++k) {
    const auto [place, weight] = kGaussLegendre[k];
    accelerate(derivative(model, move(model, from, place * dt), (1.0 - place) * dt), weight * std::abs(dt));
  }
  return Q;
}

/// Variances added by slips, skids and drifts in a second.
Vector noise_rates(const WheeledModel& model, const WheeledState& from) {
  const std::array<double, 2> speeds = wheel_speeds(model, from);
  const double skid = model.skid * model.skid * base::hypot(from.mean[kForward], from.mean[kLeft]);
  const double drift = model.drift * model.drift;
  const double slip = model.slip * model.slip;
  Vector rates = Vector::Zero();
  rates(kX) = rates(kY) = skid;
  rates(kLeftRolled) = slip * std::abs(speeds[0]);
  rates(kRightRolled) = slip * std::abs(speeds[1]);
  rates(kLeftScale) = rates(kRightScale) = rates(kTrackScale) = drift;
  rates(kGyroBias) = model.bias_drift * model.bias_drift;
  return rates;
}

/// Columns of a row of the derivative that may differ from 0, besides the diagonal.
constexpr std::array<int, 4> kPoseColumns{kYaw, kForward, kLeft, kTurn};
constexpr std::array<int, 1> kYawColumns{kTurn};
constexpr std::array<int, 2> kForwardColumns{kLeft, kTurn}, kLeftColumns{kForward, kTurn};
constexpr std::array<int, 4> kLeftRolledColumns{kForward, kTurn, kLeftScale, kTrackScale};
constexpr std::array<int, 4> kRightRolledColumns{kForward, kTurn, kRightScale, kTrackScale};
constexpr std::array<std::span<const int>, kMoved> kColumns{kPoseColumns,       kPoseColumns,       kYawColumns,
                                                            kForwardColumns,    kLeftColumns,       {},
                                                            kLeftRolledColumns, kRightRolledColumns};

/// Returns F A.
template <class Derived>
auto moved_rows(const MovedRows& F, const Eigen::MatrixBase<Derived>& A) {
  Eigen::Matrix<double, kMoved, Derived::ColsAtCompileTime, Eigen::RowMajor> rows;
  for (int i = 0; i < kMoved; ++i) {
    rows.row(i) = F(i, i) * A.row(i);
    for (const int k : kColumns[i])
      if (F(i, k) != 0.0) rows.row(i) += F(i, k) * A.row(k);
  }
  return rows;
}

}  // namespace

WheeledState predict(const WheeledModel& model, const WheeledState& state, std::int64_t time) {
  if (time == state.time) return state;
  const double dt = 1e-9 * static_cast<double>(time - state.time), seconds = std::abs(dt);
  const MovedRows F = derivative(model, state, dt);
  const Vector rates = noise_rates(model, state);
  MovedMatrix Q = acceleration_noise(model, state, dt, F);
  Q.diagonal() += seconds * rates.head<kMoved>();
  WheeledState later = move(model, state, dt);
  later.time = time;

  // The block of the constants is unchanged, except for drifts.
  Eigen::Map<Matrix> P(later.covariance.data());
  const MovedRows rows = moved_rows(F, covariance_of(state));
  P.topRows<kMoved>() = rows;
  P.bottomLeftCorner<kSize - kMoved, kMoved>() = rows.rightCols<kSize - kMoved>().transpose();
  const Eigen::Matrix<double, kSize, kMoved, Eigen::RowMajor> columns = rows.transpose();
  const MovedMatrix moved = moved_rows(F, columns) + Q.transpose();
  P.topLeftCorner<kMoved, kMoved>() = 0.5 * (moved + moved.transpose());
  P.diagonal().tail<kSize - kMoved>() += seconds * rates.tail<kSize - kMoved>();
  return later;
}

void set_variance(WheeledState& state, std::size_t component, double variance) {
  Eigen::Map<Matrix> P(state.covariance.data());
  const auto k = static_cast<Eigen::Index>(component);
  P.row(k).setZero();
  P.col(k).setZero();
  P(k, k) = variance;
}

void set_covariance(WheeledState& state, std::size_t a, std::size_t b, double covariance) {
  state.covariance[a * kWheeledComponents + b] = state.covariance[b * kWheeledComponents + a] = covariance;
}

WheeledState merged(double weight_a, const WheeledState& a, double weight_b, const WheeledState& b) {
  const double share = weight_b / (weight_a + weight_b);
  Vector d = mean_of(b) - mean_of(a);
  d(kYaw) = base::wrap_angle(d(kYaw));
  WheeledState state = a;
  Eigen::Map<Vector>(state.mean.data()) += share * d;
  state.mean[kYaw] = base::wrap_angle(state.mean[kYaw]);
  const Matrix P =
      (1.0 - share) * covariance_of(a) + share * covariance_of(b) + share * (1.0 - share) * d * d.transpose();
  Eigen::Map<Matrix>(state.covariance.data()) = 0.5 * (P + P.transpose());
  return state;
}

Estimate estimate_of(const WheeledState& state) {
  const auto [X_WM, velocity] = motion_of(state);
  Estimate estimate{state.time, X_WM, velocity};
  Eigen::Map<Matrix6>(estimate.covariance.data()) = covariance_of(state).topLeftCorner<6, 6>();
  return estimate;
}

}  // namespace sf::estimation
