#include "robots/car_dynamics.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "robots/runge_kutta.h"

namespace sf::robots {

namespace {

struct PlaceOfWheel {
  double x, y;  ///< [m] from the centre of gravity
  bool front;
};

PlaceOfWheel place_of(const CarModel& m, std::size_t wheel) {
  const bool front = wheel < kRearLeft, left = wheel % 2 == 0;
  const double half = 0.5 * (front ? m.front_track : m.rear_track);
  return {front ? m.front : -m.rear, left ? half : -half, front};
}

/// Force over load of each tyre in its wheel's frame, at its friction under static load.
struct Grip {
  double along = 0.0, across = 0.0, cosine = 1.0, sine = 0.0;
};

Grip grip_of(const CarModel& m, const CarState& s, std::size_t wheel) {
  const PlaceOfWheel at = place_of(m, wheel);
  const base::SinCos steer = base::sin_cos(at.front ? s[kCarSteer] : 0.0);
  Grip grip{.cosine = steer.cos, .sine = steer.sin};
  const double vx = s[kCarForward] - s[kCarTurn] * at.y, vy = s[kCarLeft] + s[kCarTurn] * at.x;
  const double ahead = grip.cosine * vx + grip.sine * vy, aside = grip.cosine * vy - grip.sine * vx;
  const double rim = rim_speed(m, s, wheel);
  const double reference = std::max({std::abs(rim), std::abs(ahead), kSlipSpeed});
  const double along = (rim - ahead) / reference;
  const double across = -(at.front ? m.front_stiffness : m.rear_stiffness) * aside / reference;
  const double slip = base::hypot(along, across);
  const double per_slip = slip < 1e-9 ? m.friction.slope() : m.friction.at(slip) / slip;
  grip.along = per_slip * along;
  grip.across = per_slip * across;
  return grip;
}

double load_of(const CarModel& m, std::size_t wheel, double forward, double left) {
  const PlaceOfWheel at = place_of(m, wheel);
  const double moment = m.mass * m.height;
  const double pitch = 0.5 * moment * forward / m.wheelbase();
  const double roll = moment * left * (at.front ? m.front_roll / m.front_track : (1.0 - m.front_roll) / m.rear_track);
  const double rest = 0.5 * (at.front ? m.front_load() : m.rear_load());
  return std::max(0.0, rest + (at.front ? -pitch : pitch) + (at.y > 0.0 ? -roll : roll));
}

/// Adds up the forces of all tyres for loads that belong to the accelerations in `f`.
void add_forces(const CarModel& m, const std::array<Grip, kWheels>& grips, double resistance, CarForces& f) {
  double forward = -resistance, left = 0.0, moment = 0.0;
  for (std::size_t k = 0; k < kWheels; ++k) {
    const PlaceOfWheel at = place_of(m, k);
    f.load[k] = load_of(m, k, f.forward, f.left);
    const double rest = load_of(m, k, 0.0, 0.0);
    const double force = f.load[k] * std::max(0.1, 1.0 - m.load_loss * (f.load[k] / rest - 1.0));
    f.along[k] = force * grips[k].along;
    f.across[k] = force * grips[k].across;
    const double fx = grips[k].cosine * f.along[k] - grips[k].sine * f.across[k];
    const double fy = grips[k].sine * f.along[k] + grips[k].cosine * f.across[k];
    forward += fx, left += fy, moment += at.x * fy - at.y * fx;
  }
  f.forward = forward / m.mass, f.left = left / m.mass, f.turn = moment / m.inertia;
}

/// Torque on one wheel. Brakes act against its rotation and fade out at rest.
double wheel_torque(const CarModel& m, std::size_t wheel, double spin, double torque) {
  const bool front = wheel < kRearLeft;
  if (torque >= 0.0) return front ? 0.5 * torque : 0.0;
  const double share = front ? m.brake_share : 1.0 - m.brake_share;
  return 0.5 * share * torque * std::clamp(spin, -1.0, 1.0);
}

}  // namespace

double Friction::at(double slip) const {
  const double s = std::min(slip, 1.0);
  return c1 * (1.0 - base::exp(-c2 * s)) - c3 * s;
}

double CarModel::resistance(double speed) const {
  return (drag * speed * speed + rolling * mass * kGravity) * speed / std::sqrt(speed * speed + 0.01);
}

CarState straight(const CarModel& model, double speed) {
  CarState state{};
  state[kCarForward] = speed;
  std::fill_n(state.begin() + kCarSpin, std::size_t{kWheels}, speed / model.wheel_radius);
  return state;
}

CarForces car_forces(const CarModel& m, const CarState& s) {
  std::array<Grip, kWheels> grips;
  for (std::size_t k = 0; k < kWheels; ++k) grips[k] = grip_of(m, s, k);
  // Loads depend on accelerations and these on loads. A transfer of load changes the sum of forces little, so the
  // iteration contracts by at least a third per round.
  CarForces forces;
  const double resistance = m.resistance(s[kCarForward]);
  for (int round = 0; round < 40; ++round) {
    const double forward = forces.forward, left = forces.left;
    add_forces(m, grips, resistance, forces);
    if (std::abs(forces.forward - forward) + std::abs(forces.left - left) < 1e-11) break;
  }
  return forces;
}

CarState car_rate(const CarModel& m, const CarState& s, const CarCommand& command) {
  const CarForces forces = car_forces(m, s);
  const auto [n, c] = base::sin_cos(s[kCarYaw]);
  CarState rate{};
  rate[kCarX] = c * s[kCarForward] - n * s[kCarLeft];
  rate[kCarY] = n * s[kCarForward] + c * s[kCarLeft];
  rate[kCarYaw] = s[kCarTurn];
  rate[kCarForward] = forces.forward + s[kCarTurn] * s[kCarLeft];
  rate[kCarLeft] = forces.left - s[kCarTurn] * s[kCarForward];
  rate[kCarTurn] = forces.turn;
  for (std::size_t k = 0; k < kWheels; ++k) {
    const double torque = wheel_torque(m, k, s[kCarSpin + k], s[kCarTorque]);
    rate[kCarSpin + k] = (torque - m.wheel_radius * forces.along[k]) / m.wheel_inertia;
  }
  const double steer = std::clamp(command.steer, -m.steer_limit, m.steer_limit);
  rate[kCarSteer] = std::clamp((steer - s[kCarSteer]) / m.steer_lag, -m.steer_rate, m.steer_rate);
  rate[kCarTorque] = (std::clamp(command.torque, -m.brake_limit, m.drive_limit) - s[kCarTorque]) / m.torque_lag;
  return rate;
}

CarState step(const CarModel& model, const CarState& state, const CarCommand& command, double dt) {
  return runge_kutta(state, dt, [&](const CarState& at) { return car_rate(model, at, command); });
}

double rim_speed(const CarModel& model, const CarState& state, std::size_t wheel) {
  return model.wheel_radius * state[kCarSpin + wheel];
}

double sideslip(const CarState& state) { return base::atan2(state[kCarLeft], state[kCarForward]); }

}  // namespace sf::robots
