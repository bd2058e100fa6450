#pragma once
// Parameters of a passenger car and of its tyres.
//
// Masses, lengths, tracks, brakes and steering are those of the Ford Escort in CommonRoad's vehicle parameter set 1 (M.
// Althoff, M. Koschi and S. Manzinger, CommonRoad: composable benchmarks for motion planning on roads, IEEE Intelligent
// Vehicles Symposium 2017). Friction is Burckhardt's for dry asphalt (M. Burckhardt, Fahrwerktechnik:
// Radschlupf-Regelsysteme, 1993). The rear lateral stiffness is that of CommonRoad's tyre, 21.92 per radian and load.
// Assumed: the front one, lower by the elasticity of the steering, for an understeer gradient of 1.6 degrees per g; the
// loss of friction with load; the front share of the roll moment; resistances; lags and the limit of the engine.

namespace sf::robots {

inline constexpr double kGravity = 9.81;  ///< [m/s^2]

/// Burckhardt's friction curve c1 (1 - exp(-c2 s)) - c3 s.
struct Friction {
  double c1 = 1.2801;
  double c2 = 23.99;
  double c3 = 0.52;

  /// Returns force over load at a combined slip >= 0. A slip above 1 counts as 1.
  double at(double slip) const;
  /// Returns its derivative at slip 0.
  double slope() const { return c1 * c2 - c3; }
};

/// All parameters are > 0 unless a range is stated. Forward is x, left is y, the origin is the centre of gravity.
struct CarModel {
  double mass = 1225.9;           ///< [kg]
  double inertia = 1538.9;        ///< [kg m^2] about the vertical
  double front = 0.88392;         ///< [m] from the centre of gravity to the front axle
  double rear = 1.50876;          ///< [m] to the rear axle
  double height = 0.5578;         ///< [m] >= 0 of the centre of gravity
  double front_track = 1.3899;    ///< [m]
  double rear_track = 1.4234;     ///< [m]
  double wheel_radius = 0.344;    ///< [m]
  double wheel_inertia = 1.7;     ///< [kg m^2] of one wheel
  Friction friction;              ///< by combined slip
  double front_stiffness = 0.45;  ///< [-] lateral slip counts this much in the combined slip of a front wheel
  double rear_stiffness = 0.726;  ///< [-] the same of a rear wheel
  double load_loss = 0.1;         ///< [-] in [0, 0.5] part of its friction that a wheel loses at twice its static load
  double front_roll = 0.6;        ///< [-] in [0, 1] share of the roll moment that the front axle bears
  double drag = 0.42;             ///< [N s^2/m^2] >= 0
  double rolling = 0.012;         ///< [-] >= 0 resistance over weight

  // Actuators. The front axle is driven and steered.
  double steer_limit = 0.91;    ///< [rad]
  double steer_rate = 0.4;      ///< [rad/s]
  double steer_lag = 0.05;      ///< [s] time constant
  double drive_limit = 1500.0;  ///< [N m] at both front wheels together
  double brake_limit = 5000.0;  ///< [N m] at all wheels together
  double brake_share = 0.76;    ///< [-] in [0, 1] at the front
  double torque_lag = 0.1;      ///< [s] time constant

  double wheelbase() const { return front + rear; }
  /// Returns the static load [N] of both wheels of an axle.
  double front_load() const { return mass * kGravity * rear / wheelbase(); }
  double rear_load() const { return mass * kGravity * front / wheelbase(); }
  /// Returns the cornering stiffness [N/rad] of an axle at small slip.
  double front_cornering() const { return front_load() * front_stiffness * friction.slope(); }
  double rear_cornering() const { return rear_load() * rear_stiffness * friction.slope(); }
  /// Returns the understeer gradient [rad s^2/m]: change of the steering angle per lateral acceleration on a circle.
  double understeer() const { return mass * (rear / front_cornering() - front / rear_cornering()) / wheelbase(); }
  /// Returns the force [N] of air and rolling against motion at `speed` [m/s] forward; odd and smooth.
  double resistance(double speed) const;
};

}  // namespace sf::robots
