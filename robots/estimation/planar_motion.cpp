#include "robots/estimation/planar_motion.h"

#include <cmath>

#include "base/elementary.h"
#include "robots/kinematics.h"

namespace sf::estimation {

namespace {

/// d/dx of sin(x)/x. Below the threshold, the next term of the series is below 1e-11.
double sinc_slope(double x) {
  if (std::abs(x) < 1e-2) return x * (-1.0 / 3.0 + x * x / 30.0);
  return (base::cos(x) - base::sin(x) / x) / x;
}

}  // namespace

Motion move(MotionModel::Path path, const Motion& from, double dt) {
  const base::Twist& v = from.velocity;
  if (path == MotionModel::Path::arc) return {robots::advance(from.X_WM, v, dt), v};
  const base::Pose& X = from.X_WM;
  const glm::dvec2 d = dt * base::rotate(X.yaw, {v.forward, v.left});
  const glm::dvec2 later = base::rotate(-v.turn * dt, {v.forward, v.left});
  return {{X.x + d.x, X.y + d.y, X.z, base::wrap_angle(X.yaw + v.turn * dt)}, {later.x, later.y, v.turn}};
}

std::array<double, kComponents * kComponents> jacobian(MotionModel::Path path, const Motion& from, double dt) {
  const double yaw = from.X_WM.yaw;
  const auto& [forward, left, turn] = from.velocity;
  std::array<double, kComponents * kComponents> F{};
  const auto at = [&](std::size_t row, std::size_t column) -> double& { return F[row * kComponents + column]; };
  for (std::size_t k = 0; k < kComponents; ++k) at(k, k) = 1.0;
  at(kYaw, kTurn) = dt;
  const auto set_column = [&](Component row, Component column, glm::dvec2 d) {
    at(row, column) = d.x;
    at(row + 1u, column) = d.y;
  };
  const auto perpendicular = [](glm::dvec2 d) { return glm::dvec2{-d.y, d.x}; };

  if (path == MotionModel::Path::arc) {
    // The chord R(yaw + h) v sinc(h) dt with h = turn dt / 2.
    const double h = 0.5 * turn * dt;
    const double length = dt * base::sinc(h);
    const glm::dvec2 d = base::rotate(yaw + h, {length * forward, length * left});
    const double stretch = 0.5 * dt * dt * sinc_slope(h);
    set_column(kX, kYaw, perpendicular(d));
    set_column(kX, kForward, base::rotate(yaw + h, {length, 0.0}));
    set_column(kX, kLeft, base::rotate(yaw + h, {0.0, length}));
    set_column(kX, kTurn, 0.5 * dt * perpendicular(d) + base::rotate(yaw + h, {stretch * forward, stretch * left}));
    return F;
  }
  set_column(kX, kYaw, dt * perpendicular(base::rotate(yaw, {forward, left})));
  set_column(kX, kForward, base::rotate(yaw, {dt, 0.0}));
  set_column(kX, kLeft, base::rotate(yaw, {0.0, dt}));
  set_column(kForward, kForward, base::rotate(-turn * dt, {1.0, 0.0}));
  set_column(kForward, kLeft, base::rotate(-turn * dt, {0.0, 1.0}));
  set_column(kForward, kTurn, -dt * perpendicular(base::rotate(-turn * dt, {forward, left})));
  return F;
}

}  // namespace sf::estimation
