#include "robots/estimation/wheeled_state.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>

#include "base/elementary.h"
#include "robots/estimation/planar_motion.h"

namespace sf::estimation {

namespace {

constexpr int kSize = kWheeledComponents;
constexpr int kMoved = kLeftScale;  // the components before are changed by motion, the others are constants
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector = Eigen::Matrix<double, kSize, 1>;
using Matrix = Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>;
using MovedRows = Eigen::Matrix<double, kMoved, kSize, Eigen::RowMajor>;
using MovedMatrix = Eigen::Matrix<double, kMoved, kMoved, Eigen::RowMajor>;
// One row or column per measured value.
template <int N>
using Values = Eigen::Matrix<double, N, 1>;
template <int N>
using ValuesMatrix = Eigen::Matrix<double, N, N, Eigen::RowMajor>;
template <int N>
using Rows = Eigen::Matrix<double, N, kSize, Eigen::RowMajor>;

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

/// Returns the rows that differ from the identity of the derivative of the state after `dt` with respect to `state`.
MovedRows derivative(const WheeledModel& model, const WheeledState& state, double dt) {
  MovedRows F = MovedRows::Identity();
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

/// First component and number of components, by kind of measurement.
constexpr std::array<std::array<int, 2>, 5> kMeasured{{{kX, 3}, {kX, 2}, {kTurn, 1}, {kLeftRolled, 2}, {kX, 2}}};

/// The measured values minus the predicted ones, their noise, and up to three numbers of each row of their derivative
/// H.
template <int N>
struct Residual {
  struct Part {
    int column = 0;
    double value = 0.0;
  };
  std::array<std::array<Part, 3>, N> H{};
  int parts = 1;  ///< per row, in the order of columns
  Values<N> difference;
  ValuesMatrix<N> noise;

  /// Returns H A. @param row returns the row of A
  template <class Row>
  auto times(const Row& row) const {
    Eigen::Matrix<double, N, std::decay_t<decltype(row(0))>::ColsAtCompileTime, Eigen::RowMajor> product;
    for (int i = 0; i < N; ++i) {
      product.row(i) = H[i][0].value * row(H[i][0].column);
      for (int k = 1; k < parts; ++k) product.row(i) += H[i][k].value * row(H[i][k].column);
    }
    return product;
  }
};

/// The measured rate is scale * turn + bias.
void predict_rate(const WheeledState& state, const WheeledMeasurement& m, Residual<1>& all) {
  const double scale = state.mean[kGyroScale], turn = state.mean[kTurn];
  all.parts = 3;
  all.H[0] = {{{kTurn, scale}, {kGyroBias, 1.0}, {kGyroScale, turn}}};
  all.difference(0) = m.values[0] - scale * turn - state.mean[kGyroBias];
}

/// A landmark is seen at R^T (landmark - position).
void predict_sighting(const WheeledState& state, const WheeledMeasurement& m, Residual<2>& all) {
  const auto [s, c] = base::sin_cos(state.mean[kYaw]);
  const Eigen::Vector2d d(m.landmark[0] - state.mean[kX], m.landmark[1] - state.mean[kY]);
  const Eigen::Vector2d seen(c * d.x() + s * d.y(), c * d.y() - s * d.x());
  all.parts = 3;
  all.H = {{{{{kX, -c}, {kY, -s}, {kYaw, seen.y()}}}, {{{kX, s}, {kY, -c}, {kYaw, -seen.x()}}}}};
  all.difference << m.values[0] - seen.x(), m.values[1] - seen.y();
}

template <int N>
Residual<N> residual_of(const WheeledState& state, const WheeledMeasurement& m) {
  using enum WheeledMeasurement::Kind;
  const int first = kMeasured[static_cast<std::size_t>(m.kind)][0];
  Residual<N> all;
  const auto& c = m.covariance;
  const std::array<double, 9> full{c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]};
  for (int i = 0; i < N; ++i) {
    all.H[i][0] = {first + i, 1.0};
    all.difference(i) = m.values[i] - state.mean[first + i];
    for (int j = 0; j < N; ++j) all.noise(i, j) = full[3 * i + j];
  }
  if constexpr (N == 1) predict_rate(state, m, all);
  if constexpr (N == 2)
    if (m.kind == sighting) predict_sighting(state, m, all);
  if constexpr (N == 3) all.difference(kYaw) = base::wrap_angle(all.difference(kYaw));
  return all;
}

/// Returns what `use` returns for the residual.
template <class Use>
auto with_residual(const WheeledState& state, const WheeledMeasurement& m, const Use& use) {
  const int count = kMeasured[static_cast<std::size_t>(m.kind)][1];
  if (count == 1) return use(residual_of<1>(state, m));
  if (count == 2) return use(residual_of<2>(state, m));
  return use(residual_of<3>(state, m));
}

/// H P.
template <int N>
Rows<N> measured_rows(const Residual<N>& residual, const WheeledState& state) {
  const auto P = covariance_of(state);
  return residual.times([&](int k) -> Eigen::Matrix<double, 1, kSize> { return P.row(k); });
}

/// Covariance of the residual. @param HP H P
template <int N>
ValuesMatrix<N> innovation_covariance(const Residual<N>& residual, const Rows<N>& HP) {
  const ValuesMatrix<N> transposed = residual.times([&](int k) -> Eigen::Matrix<double, 1, N> { return HP.col(k); });
  return transposed.transpose() + residual.noise;
}

/// Lower triangle L with L L^T = S.
template <int N>
ValuesMatrix<N> cholesky(const ValuesMatrix<N>& S) {
  ValuesMatrix<N> L = S;
  for (int k = 0; k < N; ++k)
    for (int i = k; i < N; ++i) {
      double sum = 0.0;
      for (int j = 0; j < k; ++j) sum += L(i, j) * L(k, j);
      L(i, k) = i == k ? std::sqrt(L(k, k) - sum) : (L(i, k) - sum) / L(k, k);
    }
  return L;
}

/// Returns S^-1 B, given the lower triangle of S.
template <int N, class B>
B solved(const ValuesMatrix<N>& L, B rows) {
  for (int i = 0; i < N; ++i) {
    for (int k = 0; k < i; ++k) rows.row(i) -= L(i, k) * rows.row(k);
    rows.row(i) *= 1.0 / L(i, i);
  }
  for (int i = N - 1; i >= 0; --i) {
    for (int k = i + 1; k < N; ++k) rows.row(i) -= L(k, i) * rows.row(k);
    rows.row(i) *= 1.0 / L(i, i);
  }
  return rows;
}

/// Corrects the covariance in Joseph's form (I - K H) P (I - K H)^T + K R K^T, with products of few rows.
/// @param HP H P @param Kt K^T
template <int N>
void correct_covariance(const Residual<N>& residual, const Rows<N>& HP, const Rows<N>& Kt, WheeledState& state) {
  Matrix P = covariance_of(state);
  for (int a = 0; a < kSize; ++a) {
    Eigen::Matrix<double, 1, kSize> gained = Kt(0, a) * HP.row(0);
    for (int i = 1; i < N; ++i) gained += Kt(i, a) * HP.row(i);
    P.row(a) -= gained;
  }
  const Rows<N> HPt = residual.times([&](int k) -> Eigen::Matrix<double, 1, kSize> { return P.col(k); });
  Rows<N> RKt;
  for (int i = 0; i < N; ++i) {
    RKt.row(i) = residual.noise(i, 0) * Kt.row(0);
    for (int j = 1; j < N; ++j) RKt.row(i) += residual.noise(i, j) * Kt.row(j);
  }
  for (int a = 0; a < kSize; ++a) {
    Eigen::Matrix<double, 1, kSize> lost = HPt(0, a) * Kt.row(0), added = Kt(0, a) * RKt.row(0);
    for (int i = 1; i < N; ++i) lost += HPt(i, a) * Kt.row(i), added += Kt(i, a) * RKt.row(i);
    P.row(a) = P.row(a) - lost + added;
  }
  store_symmetric(P, state);
}

}  // namespace

bool is_valid(const WheeledMeasurement& m) {
  const WheeledState origin{.mean = {}};
  if (m.time < 0 || m.time > std::int64_t{1} << 62) return false;
  const bool definite = with_residual(origin, m, [](const auto& residual) {
    const auto in_range = [](double v) { return v >= 1e-18 && v <= 1e18; };
    return std::all_of(residual.noise.diagonal().begin(), residual.noise.diagonal().end(), in_range) &&
           residual.noise.llt().info() == Eigen::Success;
  });
  const auto within = [](double v) { return std::abs(v) <= 1e9; };
  return std::all_of(m.values.begin(), m.values.end(), within) &&
         std::all_of(m.landmark.begin(), m.landmark.end(), within) &&
         std::all_of(m.covariance.begin(), m.covariance.end(), [](double v) { return std::abs(v) <= 1e18; }) &&
         std::isfinite(m.z) && definite;
}

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

Innovation innovation(const WheeledState& predicted, const WheeledMeasurement& measurement) {
  return with_residual(predicted, measurement, [&]<int N>(const Residual<N>& residual) {
    const ValuesMatrix<N> L = cholesky<N>(innovation_covariance(residual, measured_rows(residual, predicted)));
    const Values<N> y = L.template triangularView<Eigen::Lower>().solve(residual.difference);
    return Innovation{y.squaredNorm(), N, 2.0 * L.diagonal().unaryExpr(&base::log).sum()};
  });
}

WheeledState correct(const WheeledState& predicted, const WheeledMeasurement& measurement) {
  WheeledState state = predicted;
  with_residual(predicted, measurement, [&]<int N>(const Residual<N>& residual) {
    const Rows<N> HP = measured_rows(residual, predicted);
    const Rows<N> Kt = solved(cholesky<N>(innovation_covariance(residual, HP)), HP);
    Eigen::Map<Vector>(state.mean.data()) += Kt.transpose().lazyProduct(residual.difference);
    correct_covariance(residual, HP, Kt, state);
  });
  state.mean[kYaw] = base::wrap_angle(state.mean[kYaw]);
  if (measurement.kind == WheeledMeasurement::Kind::pose) state.z = measurement.z;
  return state;
}

void replace(WheeledState& state, const WheeledMeasurement& measurement) {
  const int first = kMeasured[static_cast<std::size_t>(measurement.kind)][0];
  with_residual(state, measurement, [&]<int N>(const Residual<N>& residual) {
    for (int i = 0; i < N; ++i) {
      state.mean[first + i] = measurement.values[i];
      set_variance(state, first + i, 0.0);
    }
    Eigen::Map<Matrix>(state.covariance.data()).block<N, N>(first, first) = residual.noise;
  });
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
