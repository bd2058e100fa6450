#pragma once
// Planar dynamics of a car with four wheels: combined slip, load transfer, spinning wheels, actuators.
//
//   CarState state = straight(model, 25.0);
//   state = step(model, state, {.steer = 0.05, .torque = 100.0});
//
// Loads follow the accelerations at once (quasi-static), along and across; a wheel that lifts has none. Slip relates to
// the faster of the wheel's circumference and its motion over the ground, as in U. Kiencke and L. Nielsen, Automotive
// Control Systems, 2005. Roll, pitch and bounce would be further components of the state: forces depend on the state
// only through `car_forces`.

#include <array>
#include <cstddef>

#include "robots/car_model.h"

namespace sf::robots {

enum Wheel : std::size_t { kFrontLeft, kFrontRight, kRearLeft, kRearRight, kWheels };

/// Components of a state. Positions are in the world frame, velocities in the car's.
enum CarComponent : std::size_t {
  kCarX,                           ///< [m] of the centre of gravity
  kCarY,                           ///< [m]
  kCarYaw,                         ///< [rad] not wrapped
  kCarForward,                     ///< [m/s]
  kCarLeft,                        ///< [m/s]
  kCarTurn,                        ///< [rad/s]
  kCarSpin,                        ///< [rad/s] of the four wheels, in the order of Wheel
  kCarSteer = kCarSpin + kWheels,  ///< [rad] of both front wheels, left positive
  kCarTorque,                      ///< [N m] > 0: of the engine on the front wheels; < 0: of the brakes
  kCarComponents
};
using CarState = std::array<double, kCarComponents>;

struct CarCommand {
  double steer = 0.0;   ///< [rad] limited by the model, as the torque is
  double torque = 0.0;  ///< [N m] > 0: engine, < 0: brakes
};

/// Forces on the car in one state.
struct CarForces {
  std::array<double, kWheels> along{};   ///< [N] of each tyre, in the direction that its wheel points to
  std::array<double, kWheels> across{};  ///< [N] to the left of it
  std::array<double, kWheels> load{};    ///< [N] >= 0
  double forward = 0.0;                  ///< [m/s^2] acceleration of the centre of gravity, including resistances
  double left = 0.0;                     ///< [m/s^2] what an accelerometer there measures across
  double turn = 0.0;                     ///< [rad/s^2]
};

/// [s] Step of `step`: stable for wheels that spin at any speed.
inline constexpr double kCarStep = 5e-4;
/// [m/s] Slip relates to at least this speed, so wheels at rest have no singularity.
inline constexpr double kSlipSpeed = 3.0;

/// Returns a car that drives straight ahead at `speed` [m/s], with its wheels rolling and no torque.
CarState straight(const CarModel& model, double speed);

CarForces car_forces(const CarModel& model, const CarState& state);

/// Returns the derivative of a state.
CarState car_rate(const CarModel& model, const CarState& state, const CarCommand& command);

/// Returns the state after `dt` [s], in (0, kCarStep], by the Runge-Kutta method of order four.
CarState step(const CarModel& model, const CarState& state, const CarCommand& command, double dt = kCarStep);

/// Returns the circumferential speed [m/s] of a wheel.
double rim_speed(const CarModel& model, const CarState& state, std::size_t wheel);

/// Returns the angle [rad] from the car's forward direction to its velocity, left positive.
double sideslip(const CarState& state);

}  // namespace sf::robots
