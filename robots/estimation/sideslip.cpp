#include "robots/estimation/sideslip.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/elementary.h"
#include "robots/runge_kutta.h"

namespace sf::estimation {

namespace {

using SlipMatrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using SideslipKind = SideslipMeasurement::Kind;

constexpr double kLongestStep = 0.01;     // [s] of the integration
constexpr double kLongestInterval = 0.1;  // [s] over which one measurement corrects
constexpr double kCoupled = 0.05;         // [-] least effect of the sideways speed on the yaw rate, see `coupling`
constexpr double kMostGain = 50.0;        // largest `left` and `equivalent` of TurnGains
constexpr double kSlowest = 3.0;          // [1/s] least frequency from which poles are placed
constexpr double kMostSpeed = 500.0;      // [m/s] of any car
constexpr double kMostTurn = 30.0;        // [rad/s] of any car

Eigen::Map<SlipMatrix> covariance_of(SideslipState& state) { return Eigen::Map<SlipMatrix>(state.covariance.data()); }

/// Returns the derivative of `function` at a state, as a matrix.
template <class Function>
SlipMatrix slope_of(const SingleTrackState& at, Function&& function) {
  const std::array<double, 9> numbers = derivative_of(at, function);
  return Eigen::Map<const SlipMatrix>(numbers.data());
}

void advance_by(const SideslipModel& model, double dt, SideslipState& state) {
  const SingleTrack track = model.track();
  const auto next = [&](const SingleTrackState& from) {
    return robots::runge_kutta(from, dt, [&](const SingleTrackState& at) { return rate(track, at, state.input); });
  };
  if (model.observer == SideslipObserver::ekf) {
    const SlipMatrix F = slope_of(state.mean, next);
    auto P = covariance_of(state);
    SlipMatrix later = F * P * F.transpose();
    later.diagonal() += dt * Eigen::Vector3d(model.forward, model.left, model.turn);
    P = 0.5 * (later + later.transpose());
  }
  state.mean = next(state.mean);
}

/// Scalar update in Joseph form.
void correct_filter(std::size_t component, double value, double sigma, SideslipState& state) {
  auto P = covariance_of(state);
  const auto row = static_cast<Eigen::Index>(component);
  const Eigen::Vector3d gain = P.col(row) / (P(row, row) + sigma * sigma);
  Eigen::Map<Eigen::Vector3d>(state.mean.data()) += gain * (value - state.mean[component]);
  SlipMatrix rest = SlipMatrix::Identity();
  rest.col(row) -= gain;
  const SlipMatrix corrected = rest * P * rest.transpose() + sigma * sigma * gain * gain.transpose();
  P = 0.5 * (corrected + corrected.transpose());
}

/// Gains of an error of the yaw rate.
struct TurnGains {
  double left = 0.0;        ///< [m/s] per second and [rad/s] of the error: on the sideways speed
  double turn = 0.0;        ///< [1/s] on the yaw rate
  double equivalent = 0.0;  ///< [m/rad] correction of the sideways speed over that of the yaw rate, in sliding mode
};

/// Places both poles of sideways speed and yaw rate, linearised at the estimate.
TurnGains turn_gains(const SideslipModel& model, const SideslipState& state) {
  const std::array<double, 9> A = jacobian(model.track(), state.mean, state.input);
  const double a11 = A[4], a12 = A[5], a21 = A[7], a22 = A[8];
  const double pole = model.pace * std::max(kSlowest, std::sqrt(std::abs(a11 * a22 - a12 * a21)));
  TurnGains gains{.turn = std::max(0.0, a11 + a22 + 2.0 * pole)};
  if (std::abs(a21) * 0.5 * model.car.wheelbase() < kCoupled * std::abs(a22)) return {.turn = pole};
  const auto bounded = [](double gain) { return std::clamp(gain, -kMostGain, kMostGain); };
  gains.left = bounded(a12 + (pole * pole - a11 * (a22 - gains.turn)) / a21);
  gains.equivalent = bounded((a11 + pole) / a21);
  return gains;
}

void correct_turn(const SideslipModel& model, double error, double seconds, SideslipState& state) {
  const TurnGains gains = turn_gains(model, state);
  double turn = gains.turn * error, left = gains.left * error;
  if (model.observer == SideslipObserver::sliding_mode) {
    turn = model.turn_reach * std::clamp(error / model.turn_layer, -1.0, 1.0);
    left = gains.equivalent * turn;
  }
  state.mean[kTrackTurn] += seconds * turn;
  state.mean[kTrackLeft] += seconds * left;
}

void correct_speed(const SideslipModel& model, double value, double seconds, SideslipState& state) {
  double& speed = state.mean[kTrackForward];
  const double error = value - speed;
  if (model.observer == SideslipObserver::luenberger)
    speed = value;
  else if (model.observer == SideslipObserver::sliding_mode)
    speed += seconds * model.speed_reach * std::clamp(error / model.speed_layer, -1.0, 1.0);
  else
    speed += seconds * model.speed_pole * error;
}

void correct(const SideslipModel& model, const SideslipMeasurement& m, SideslipState& state) {
  const bool turn = m.kind == SideslipKind::turn;
  if (model.observer == SideslipObserver::ekf)
    return correct_filter(turn ? kTrackTurn : kTrackForward, m.value, turn ? model.turn_noise : model.speed_noise,
                          state);
  const std::int64_t last = state.last[static_cast<std::size_t>(m.kind)];
  const double seconds = last < 0 ? 0.0 : std::min(1e-9 * static_cast<double>(m.time - last), kLongestInterval);
  if (turn)
    correct_turn(model, m.value - state.mean[kTrackTurn], seconds, state);
  else
    correct_speed(model, m.value, seconds, state);
}

/// False for a state that no car has, as after a wrong reading: the observer then stops.
bool is_sound(const SideslipState& state) {
  if (!state.known()) return true;
  const auto within = [](double v, double most) { return std::abs(v) <= most; };
  return within(state.mean[kTrackForward], kMostSpeed) && within(state.mean[kTrackLeft], kMostSpeed) &&
         within(state.mean[kTrackTurn], kMostTurn) &&
         std::ranges::all_of(state.covariance, [&](double v) { return within(v, kMostSpeed * kMostSpeed); });
}

/// The last inputs remain.
SideslipState stopped(const SideslipState& state) {
  SideslipState none;
  none.input = state.input;
  return none;
}

}  // namespace

SideslipState started(const SideslipModel& model, std::int64_t time, double speed) {
  SideslipState state;
  state.at = time;
  state.mean = {speed, 0.0, 0.0};
  covariance_of(state).diagonal() << model.speed_noise * model.speed_noise, 0.04, 0.01;
  return state;
}

SideslipState predict(const SideslipModel& model, const SideslipState& state, std::int64_t time) {
  if (!state.known() || time <= state.at) return state;
  if (time - state.at > kSideslipGap) return stopped(state);
  SideslipState later = state;
  const double seconds = 1e-9 * static_cast<double>(time - state.at);
  const int steps = static_cast<int>(std::ceil(seconds / kLongestStep - 1e-9));
  for (int k = 0; k < steps; ++k) advance_by(model, seconds / steps, later);
  later.at = time;
  return is_sound(later) ? later : stopped(state);
}

Verdict apply(const SideslipModel& model, const SideslipMeasurement& m, SideslipState& state) {
  // No car turns or drives faster, and wheels turn less than a right angle.
  static constexpr double kMost[]{0.5 * M_PI, 1e6, kMostSpeed, kMostTurn};
  if (!(std::abs(m.value) <= kMost[static_cast<std::size_t>(m.kind)])) return Verdict::invalid;
  state = predict(model, state, m.time);
  Verdict verdict = Verdict::used;
  if (m.kind == SideslipKind::steer)
    state.input.steer = m.value;
  else if (m.kind == SideslipKind::torque)
    state.input.force = m.value / model.car.wheel_radius;
  else if (state.known())
    correct(model, m, state);
  else if (m.kind == SideslipKind::speed) {
    const SingleTrackInput input = state.input;
    state = started(model, m.time, m.value);
    state.input = input;
    verdict = Verdict::started;
  } else
    return Verdict::no_track;
  state.last[static_cast<std::size_t>(m.kind)] = m.time;
  if (!is_sound(state)) state = stopped(state);
  return verdict;
}

SideslipEstimate estimate_of(const SideslipModel& model, const SideslipState& state) {
  const SingleTrack track = model.track();
  const auto quantities = [&](const SingleTrackState& s) {
    const AxleForces f = axle_forces(track, s, state.input);
    return SingleTrackState{base::atan2(s[kTrackLeft], s[kTrackForward]), f.front, f.rear};
  };
  const SingleTrackState values = quantities(state.mean);
  SideslipEstimate estimate{values[0], {values[1], values[2]}};
  estimate.covariance.fill(std::numeric_limits<double>::quiet_NaN());
  if (model.observer != SideslipObserver::ekf) return estimate;
  const SlipMatrix J = slope_of(state.mean, quantities);
  const SlipMatrix P = J * Eigen::Map<const SlipMatrix>(state.covariance.data()) * J.transpose();
  estimate.covariance = {P(0, 0), P(0, 1), P(0, 2), P(1, 1), P(1, 2), P(2, 2)};
  return estimate;
}

}  // namespace sf::estimation
