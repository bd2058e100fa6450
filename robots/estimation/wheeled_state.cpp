#include "robots/estimation/wheeled_state.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "robots/estimation/planar_motion.h"

namespace sf::estimation {

namespace {

constexpr int kSize = kWheeledComponents;
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector = Eigen::Matrix<double, kSize, 1>;
using Matrix = Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>;
// One row or column per measured value, on the stack.
using Values = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;
using ValuesMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, kSize, Eigen::RowMajor, 3, kSize>;

Eigen::Map<const Matrix> covariance_of(const WheeledState& state) {
  return Eigen::Map<const Matrix>(state.covariance.data());
}
Eigen::Map<const Vector> mean_of(const WheeledState& state) { return Eigen::Map<const Vector>(state.mean.data()); }

void store_symmetric(const Matrix& P, WheeledState& state) {
  Eigen::Map<Matrix>(state.covariance.data()) = 0.5 * (P + P.transpose());
}

Motion motion_of(const WheeledState& state) {
  const auto& m = state.mean;
  return {{m[kX], m[kY], state.z, m[kYaw]}, {m[kForward], m[kLeft], m[kTurn]}};
}

/// [m/s] Speeds of the left and the right wheel over ground.
std::array<double, 2> wheel_speeds(const WheeledModel& model, const WheeledState& state) {
  const double half = 0.5 * model.track * state.mean[kTrackScale] * state.mean[kTurn];
  return {state.mean[kForward] - half, state.mean[kForward] + half};
}

/// Returns the derivative of the state after `dt` with respect to `state`.
Matrix derivative(const WheeledModel& model, const WheeledState& state, double dt) {
  Matrix F = Matrix::Identity();
  const std::array<double, 36> planar = jacobian(model.motion.path, motion_of(state), dt);
  F.topLeftCorner<6, 6>() = Eigen::Map<const Matrix6>(planar.data());
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
  const Motion moved = estimation::move(model.motion.path, motion_of(from), dt);
  const auto& [X, v] = moved;
  const std::array<double, 6> motion{X.x, X.y, X.yaw, v.forward, v.left, v.turn};
  std::copy(motion.begin(), motion.end(), to.mean.begin());
  const std::array<double, 2> speeds = wheel_speeds(model, from);
  for (const int right : {0, 1}) to.mean[kLeftRolled + right] += from.mean[kLeftScale + right] * speeds[right] * dt;
  return to;
}

/// Covariance of the changes of speeds at once, per second: as if the speeds had been less certain at the start.
Eigen::Vector3d speed_density(const WheeledModel& model) {
  return {model.motion.forward, model.motion.left, model.motion.turn};
}

/// Covariance added by continuous changes of speeds over dt.
Matrix acceleration_noise(const WheeledModel& model, const WheeledState& from, double dt) {
  Matrix Q = Matrix::Zero();
  for (const auto& [place, weight] : kGaussLegendre) {
    const Matrix F = derivative(model, move(model, from, place * dt), (1.0 - place) * dt);
    const auto G = F.middleCols<3>(kForward);
    Q += weight * std::abs(dt) * G * speed_density(model).asDiagonal() * G.transpose();
  }
  return Q;
}

/// Variances per second of slips, skids and drifts.
Vector drift_density(const WheeledModel& model, const WheeledState& from) {
  const std::array<double, 2> speeds = wheel_speeds(model, from);
  Vector rates = Vector::Zero();
  rates(kX) = rates(kY) = model.skid * model.skid * base::hypot(from.mean[kForward], from.mean[kLeft]);
  rates(kLeftRolled) = model.slip * model.slip * std::abs(speeds[0]);
  rates(kRightRolled) = model.slip * model.slip * std::abs(speeds[1]);
  rates(kLeftScale) = rates(kRightScale) = rates(kTrackScale) = model.drift * model.drift;
  rates(kGyroBias) = model.bias_drift * model.bias_drift;
  return rates;
}

/// Returns F P F^T. Most rows of F are those of the identity, and the others have few numbers.
Matrix carried(const Matrix& F, const Matrix& P) {
  Matrix rows = P;
  for (int i = 0; i < kSize; ++i) {
    rows.row(i) *= F(i, i);
    for (int k = 0; k < kSize; ++k)
      if (k != i && F(i, k) != 0.0) rows.row(i) += F(i, k) * P.row(k);
  }
  Matrix all = rows;
  for (int i = 0; i < kSize; ++i) {
    all.col(i) *= F(i, i);
    for (int k = 0; k < kSize; ++k)
      if (k != i && F(i, k) != 0.0) all.col(i) += F(i, k) * rows.col(k);
  }
  return all;
}

/// First component and number of components, by kind of measurement.
constexpr std::array<std::array<int, 2>, 5> kMeasured{{{kX, 3}, {kX, 2}, {kTurn, 1}, {kLeftRolled, 2}, {kX, 2}}};

/// H, the measured values minus the predicted ones, and their noise.
struct Residual {
  Rows H;
  Values difference;
  ValuesMatrix noise;
};

/// The measured rate is scale * turn + bias.
void predict_rate(const WheeledState& state, const WheeledMeasurement& m, Residual& all) {
  all.H(0, kTurn) = state.mean[kGyroScale];
  all.H(0, kGyroScale) = state.mean[kTurn];
  all.H(0, kGyroBias) = 1.0;
  all.difference(0) = m.values[0] - state.mean[kGyroScale] * state.mean[kTurn] - state.mean[kGyroBias];
}

/// A landmark is seen at R^T (landmark - position).
void predict_sighting(const WheeledState& state, const WheeledMeasurement& m, Residual& all) {
  const auto [s, c] = base::sin_cos(state.mean[kYaw]);
  const Eigen::Vector2d d(m.landmark[0] - state.mean[kX], m.landmark[1] - state.mean[kY]);
  const Eigen::Vector2d seen(c * d.x() + s * d.y(), c * d.y() - s * d.x());
  all.H.leftCols<3>() << -c, -s, seen.y(), s, -c, -seen.x();
  all.difference << m.values[0] - seen.x(), m.values[1] - seen.y();
}

Residual residual_of(const WheeledState& state, const WheeledMeasurement& m) {
  const auto [first, count] = kMeasured[static_cast<std::size_t>(m.kind)];
  Residual all{Rows::Zero(count, kSize), Values(count), ValuesMatrix(count, count)};
  const auto& c = m.covariance;
  const std::array<double, 9> full{c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]};
  for (int i = 0; i < count; ++i) {
    all.H(i, first + i) = 1.0;
    all.difference(i) = m.values[i] - state.mean[first + i];
    for (int j = 0; j < count; ++j) all.noise(i, j) = full[3 * i + j];
  }
  if (m.kind == WheeledMeasurement::Kind::gyro) predict_rate(state, m, all);
  if (m.kind == WheeledMeasurement::Kind::sighting) predict_sighting(state, m, all);
  if (m.kind == WheeledMeasurement::Kind::pose) all.difference(kYaw) = base::wrap_angle(all.difference(kYaw));
  return all;
}

}  // namespace

bool is_valid(const WheeledMeasurement& m) {
  const WheeledState origin{.mean = {}};
  if (m.time < 0 || m.time > std::int64_t{1} << 62) return false;
  const auto [H, difference, noise] = residual_of(origin, m);
  const auto in_range = [](double v) { return v >= 1e-18 && v <= 1e18; };
  const auto within = [](double v) { return std::abs(v) <= 1e9; };
  return std::all_of(m.values.begin(), m.values.end(), within) &&
         std::all_of(m.landmark.begin(), m.landmark.end(), within) &&
         std::all_of(noise.diagonal().begin(), noise.diagonal().end(), in_range) &&
         std::all_of(m.covariance.begin(), m.covariance.end(), [](double v) { return std::abs(v) <= 1e18; }) &&
         std::isfinite(m.z) && noise.llt().info() == Eigen::Success;
}

WheeledState predict(const WheeledModel& model, const WheeledState& state, std::int64_t time) {
  if (time == state.time) return state;
  const double dt = 1e-9 * static_cast<double>(time - state.time);
  WheeledState later = move(model, state, dt);
  later.time = time;
  Matrix P = covariance_of(state);
  if (model.steps) P.diagonal().segment<3>(kForward) += std::abs(dt) * speed_density(model);
  P = carried(derivative(model, state, dt), P);
  if (!model.steps) P += acceleration_noise(model, state, dt);
  P.diagonal() += std::abs(dt) * drift_density(model, state);
  store_symmetric(P, later);
  return later;
}

Innovation innovation(const WheeledState& predicted, const WheeledMeasurement& measurement) {
  const auto [H, difference, noise] = residual_of(predicted, measurement);
  const Rows HP = H.lazyProduct(covariance_of(predicted));
  const ValuesMatrix S = HP.lazyProduct(H.transpose()) + noise;
  const Eigen::LLT<ValuesMatrix> llt(S);
  return {difference.dot(llt.solve(difference)), static_cast<int>(difference.size()),
          2.0 * llt.matrixLLT().diagonal().unaryExpr(&base::log).sum()};
}

WheeledState correct(const WheeledState& predicted, const WheeledMeasurement& measurement) {
  const auto [H, difference, noise] = residual_of(predicted, measurement);
  const auto P = covariance_of(predicted);
  const Rows HP = H.lazyProduct(P);
  const ValuesMatrix S = HP.lazyProduct(H.transpose()) + noise;
  const Rows Kt = S.llt().solve(HP);
  WheeledState state = predicted;
  Eigen::Map<Vector>(state.mean.data()) += Kt.transpose().lazyProduct(difference);
  state.mean[kYaw] = base::wrap_angle(state.mean[kYaw]);
  if (measurement.kind == WheeledMeasurement::Kind::pose) state.z = measurement.z;
  // Joseph's form (I - K H) P (I - K H)^T + K R K^T, with products of few rows.
  const Matrix rest = P - Kt.transpose().lazyProduct(HP);
  const Rows Hrest = H.lazyProduct(rest.transpose());
  store_symmetric(rest - Hrest.transpose().lazyProduct(Kt) + Kt.transpose().lazyProduct(noise.lazyProduct(Kt).eval()),
                  state);
  return state;
}

void replace(WheeledState& state, const WheeledMeasurement& measurement) {
  const auto [H, difference, noise] = residual_of(state, measurement);
  Eigen::Map<Matrix> P(state.covariance.data());
  for (int i = 0; i < difference.size(); ++i) {
    int k = 0;
    H.row(i).maxCoeff(&k);
    state.mean[k] = measurement.values[i];
    set_variance(state, k, 0.0);
  }
  P += H.transpose() * noise * H;
  if (measurement.kind == WheeledMeasurement::Kind::pose) state.z = measurement.z;
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
  store_symmetric(
      (1.0 - share) * covariance_of(a) + share * covariance_of(b) + share * (1.0 - share) * d * d.transpose(), state);
  return state;
}

Estimate estimate_of(const WheeledState& state) {
  const auto [X_WM, velocity] = motion_of(state);
  Estimate estimate{state.time, X_WM, velocity};
  Eigen::Map<Matrix6>(estimate.covariance.data()) = covariance_of(state).topLeftCorner<6, 6>();
  return estimate;
}

}  // namespace sf::estimation
