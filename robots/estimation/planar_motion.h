#pragma once
// Noise-free motion of a planar object and its derivatives.

#include <array>

#include "robots/estimation/kalman.h"

namespace sf::estimation {

struct Motion {
  base::Pose X_WM;
  base::Twist velocity;
};

/// Returns the motion after `dt` [s], which may be negative.
Motion move(MotionModel::Path path, const Motion& from, double dt);

/// Returns the derivative of `move` with respect to pose and twist, row-major, in the order of Component.
std::array<double, kComponents * kComponents> jacobian(MotionModel::Path path, const Motion& from, double dt);

/// Nodes in [0, 1] and weights of three-point Gauss-Legendre quadrature.
inline constexpr std::array<std::array<double, 2>, 3> kGaussLegendre{
    {{0.1127016653792583, 5.0 / 18.0}, {0.5, 8.0 / 18.0}, {0.8872983346207417, 5.0 / 18.0}}};

}  // namespace sf::estimation
