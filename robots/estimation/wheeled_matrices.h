#pragma once
// Matrices of the filter of a robot with two driven wheels (wheeled_state.h), for its sources only.

#include <Eigen/Core>

#include "robots/estimation/wheeled_state.h"

namespace sf::estimation::wheeled {

constexpr int kSize = kWheeledComponents;
using Vector = Eigen::Matrix<double, kSize, 1>;
using Matrix = Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>;

inline Eigen::Map<const Matrix> covariance_of(const WheeledState& state) {
  return Eigen::Map<const Matrix>(state.covariance.data());
}
inline void store_symmetric(const Matrix& P, WheeledState& state) {
  Eigen::Map<Matrix>(state.covariance.data()) = 0.5 * (P + P.transpose());
}

}  // namespace sf::estimation::wheeled
