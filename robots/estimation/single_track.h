#pragma once
// The dynamic single-track model of a car: both wheels of an axle as one, static loads, steering and longitudinal force
// as inputs. The friction of its tyres is Burckhardt's, or linear in the slip angle.

#include <array>
#include <cstddef>

#include "robots/car_model.h"

namespace sf::estimation {

/// Velocity of the centre of gravity in the car's frame.
enum SingleTrackComponent : std::size_t { kTrackForward /*[m/s]*/, kTrackLeft /*[m/s]*/, kTrackTurn /*[rad/s]*/ };
using SingleTrackState = std::array<double, 3>;

struct SingleTrackInput {
  double steer = 0.0;  ///< [rad] of the front wheels, left positive
  double force = 0.0;  ///< [N] of engine or brakes, along the front wheels
};

struct SingleTrack {
  robots::CarModel car;
  bool linear = false;  ///< forces linear in slip angles, angles small, speed constant
};

/// [N] of the tyres of each axle, to the left of its wheels.
struct AxleForces {
  double front = 0.0, rear = 0.0;
};
AxleForces axle_forces(const SingleTrack& model, const SingleTrackState& state, const SingleTrackInput& input);

/// Returns the derivative of a state.
SingleTrackState rate(const SingleTrack& model, const SingleTrackState& state, const SingleTrackInput& input);

/// Returns the derivative by the state of a function of states that returns three numbers, row by row.
template <class Function>
std::array<double, 9> derivative_of(const SingleTrackState& at, Function&& function) {
  constexpr double kStep = 1e-5;
  std::array<double, 9> result{};
  for (std::size_t column = 0; column < 3; ++column) {
    SingleTrackState above = at, below = at;
    above[column] += kStep, below[column] -= kStep;
    const SingleTrackState up = function(above), down = function(below);
    for (std::size_t row = 0; row < 3; ++row) result[3 * row + column] = (up[row] - down[row]) / (2.0 * kStep);
  }
  return result;
}

/// Returns the derivative of `rate` by the state, row by row.
std::array<double, 9> jacobian(const SingleTrack& model, const SingleTrackState& state, const SingleTrackInput& input);

/// Outputs of a car: yaw rate, forward speed, or both.
struct MeasuredOutputs {
  bool turn = false, speed = false;
};

/// How well outputs and their first two derivatives determine the state of a linearised model.
struct Observability {
  int rank = 0;        ///< number of singular values >= kLeastEffect of the local observability matrix
  double least = 0.0;  ///< smallest singular value; 0: a direction of the state has no effect
  double left = 0.0;   ///< effect of the sideways speed alone: that which no change of the other components explains
};

/// Least effect that counts. Effects are those on the local observability matrix (C; CA; CA^2) in units of 1 m/s, 1
/// m/s, 0.1 rad/s and 0.1 s: with 0.02, a sideways speed of 1 m/s changes the yaw rate by 0.002 rad/s in 0.1 s.
inline constexpr double kLeastEffect = 0.02;

/// In a linear model the speed is a parameter, not part of the state of two components, so measuring it has no effect.
Observability observability(const SingleTrack& model, const SingleTrackState& state, const SingleTrackInput& input,
                            MeasuredOutputs outputs);

}  // namespace sf::estimation
