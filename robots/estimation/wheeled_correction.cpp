// Corrections of the state of a robot with two driven wheels by measurements.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/elementary.h"
#include "robots/estimation/wheeled_state.h"

namespace sf::estimation {

namespace {

using StateVector = Eigen::Matrix<double, kWheeledComponents, 1>;
using StateRow = Eigen::Matrix<double, 1, kWheeledComponents>;
using StateMatrix = Eigen::Matrix<double, kWheeledComponents, kWheeledComponents, Eigen::RowMajor>;
// One row or column per measured value.
template <int N>
using Values = Eigen::Matrix<double, N, 1>;
template <int N>
using ValuesMatrix = Eigen::Matrix<double, N, N, Eigen::RowMajor>;
template <int N>
using Rows = Eigen::Matrix<double, N, kWheeledComponents, Eigen::RowMajor>;

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
  const Eigen::Map<const StateMatrix> P(state.covariance.data());
  return residual.times([&](int k) -> StateRow { return P.row(k); });
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
  StateMatrix P = Eigen::Map<const StateMatrix>(state.covariance.data());
  for (int a = 0; a < kWheeledComponents; ++a) {
    StateRow gained = Kt(0, a) * HP.row(0);
    for (int i = 1; i < N; ++i) gained += Kt(i, a) * HP.row(i);
    P.row(a) -= gained;
  }
  const Rows<N> HPt = residual.times([&](int k) -> StateRow { return P.col(k); });
  Rows<N> RKt;
  for (int i = 0; i < N; ++i) {
    RKt.row(i) = residual.noise(i, 0) * Kt.row(0);
    for (int j = 1; j < N; ++j) RKt.row(i) += residual.noise(i, j) * Kt.row(j);
  }
  for (int a = 0; a < kWheeledComponents; ++a) {
    StateRow lost = HPt(0, a) * Kt.row(0), added = Kt(0, a) * RKt.row(0);
    for (int i = 1; i < N; ++i) lost += HPt(i, a) * Kt.row(i), added += Kt(i, a) * RKt.row(i);
    P.row(a) = P.row(a) - lost + added;
  }
  Eigen::Map<StateMatrix>(state.covariance.data()) = 0.5 * (P + P.transpose());
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
    Eigen::Map<StateVector>(state.mean.data()) += Kt.transpose().lazyProduct(residual.difference);
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
    Eigen::Map<StateMatrix>(state.covariance.data()).block<N, N>(first, first) = residual.noise;
  });
  if (measurement.kind == WheeledMeasurement::Kind::pose) state.z = measurement.z;
}

}  // namespace sf::estimation
