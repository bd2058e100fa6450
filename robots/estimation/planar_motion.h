#pragma once
// Noise-free motion of a planar object and its derivatives. Included only by sources of this folder.

#include <Eigen/Core>

#include "robots/estimation/kalman.h"

namespace sf::estimation {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

struct Motion {
  base::Pose X_WM;
  base::Twist velocity;
};

/// Returns the motion after `dt` [s], which may be negative.
Motion move(MotionModel::Path path, const Motion& from, double dt);

/// Returns the derivative of `move` with respect to pose and twist, in the order of Component.
Matrix6 jacobian(MotionModel::Path path, const Motion& from, double dt);

/// Nodes in [0, 1] and weights of three-point Gauss-Legendre quadrature.
inline constexpr std::array<std::array<double, 2>, 3> kGaussLegendre{
    {{0.1127016653792583, 5.0 / 18.0}, {0.5, 8.0 / 18.0}, {0.8872983346207417, 5.0 / 18.0}}};

}  // namespace sf::estimation
