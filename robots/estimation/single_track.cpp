#include "robots/estimation/single_track.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "robots/car_dynamics.h"

namespace sf::estimation {

namespace {

using TrackMatrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

double tyre_force(const robots::Friction& friction, double stiffness, double load, double slip_angle, bool linear) {
  if (linear) return load * stiffness * friction.slope() * slip_angle;
  const double slip = stiffness * base::tan(std::clamp(slip_angle, -1.5, 1.5));
  return std::copysign(load * friction.at(std::abs(slip)), slip);
}

}  // namespace

AxleForces axle_forces(const SingleTrack& model, const SingleTrackState& s, const SingleTrackInput& in) {
  const robots::CarModel& car = model.car;
  const double speed = std::max(s[kTrackForward], robots::kSlipSpeed);
  const double front = (s[kTrackLeft] + car.front * s[kTrackTurn]) / speed;
  const double rear = (s[kTrackLeft] - car.rear * s[kTrackTurn]) / speed;
  const auto force = [&](double stiffness, double load, double angle) {
    return tyre_force(car.friction, stiffness, load, angle, model.linear);
  };
  if (model.linear)
    return {force(car.front_stiffness, car.front_load(), in.steer - front),
            force(car.rear_stiffness, car.rear_load(), -rear)};
  return {force(car.front_stiffness, car.front_load(), in.steer - base::atan(front)),
          force(car.rear_stiffness, car.rear_load(), -base::atan(rear))};
}

SingleTrackState rate(const SingleTrack& model, const SingleTrackState& s, const SingleTrackInput& in) {
  const robots::CarModel& car = model.car;
  const AxleForces f = axle_forces(model, s, in);
  if (model.linear)
    return {0.0, (f.front + f.rear) / car.mass - s[kTrackForward] * s[kTrackTurn],
            (car.front * f.front - car.rear * f.rear) / car.inertia};
  const auto [n, c] = base::sin_cos(in.steer);
  const double across = c * f.front + n * in.force;
  return {(c * in.force - n * f.front - car.resistance(s[kTrackForward])) / car.mass + s[kTrackTurn] * s[kTrackLeft],
          (across + f.rear) / car.mass - s[kTrackTurn] * s[kTrackForward],
          (car.front * across - car.rear * f.rear) / car.inertia};
}

std::array<double, 9> jacobian(const SingleTrack& model, const SingleTrackState& state, const SingleTrackInput& in) {
  return derivative_of(state, [&](const SingleTrackState& at) { return rate(model, at, in); });
}

Observability observability(const SingleTrack& model, const SingleTrackState& state, const SingleTrackInput& in,
                            MeasuredOutputs outputs) {
  const std::array<double, 9> numbers = jacobian(model, state, in);
  const Eigen::DiagonalMatrix<double, 3> unit(1.0, 1.0, 0.1);
  TrackMatrix A = 0.1 * unit.inverse() * TrackMatrix(Eigen::Map<const TrackMatrix>(numbers.data())) * unit;
  if (model.linear) A.row(kTrackForward).setZero(), A.col(kTrackForward).setZero();
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();  // of the observability matrix
  const auto add_output = [&](Eigen::Index component) {
    Eigen::RowVector3d row = Eigen::RowVector3d::Unit(component);
    for (int derivative = 0; derivative < 3; ++derivative, row = (row * A).eval()) gram += row.transpose() * row;
  };
  if (outputs.turn) add_output(kTrackTurn);
  if (outputs.speed && !model.linear) add_output(kTrackForward);
  const Eigen::Vector3d squares = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(gram).eigenvalues();  // ascending
  Observability result{.least = std::sqrt(std::max(0.0, squares(model.linear ? 1 : 0)))};
  for (const double square : squares) result.rank += square >= kLeastEffect * kLeastEffect ? 1 : 0;
  Eigen::Matrix2d others;
  others << gram(0, 0), gram(0, 2), gram(2, 0), gram(2, 2);
  const Eigen::Vector2d shared(gram(0, 1), gram(2, 1));
  const double alone = gram(1, 1) - shared.dot(others.completeOrthogonalDecomposition().solve(shared));
  result.left = std::sqrt(std::max(0.0, alone));
  return result;
}

}  // namespace sf::estimation
