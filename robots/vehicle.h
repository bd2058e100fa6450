#pragma once
// A car in six degrees of freedom: a rigid body on four wheels with springs and dampers, over terrain, roads and the
// floor.
//
// - Suspension: a wheel has no mass of its own (but a spin), moves along the body's z axis and meets the ground below
//   in one point, within its reach. Springs are linear, with a bump stop ten times as stiff; there are no anti-roll
//   bars. The ground pushes along its normal and never pulls. A wheel rolls over the edge of a road or of the terrain
//   as a ball does, up to half of its radius high. Bump stops and corners push out of the ground by at most 1 m/s, so
//   that cars placed in the ground, and steps that corners meet, throw nothing.
// - Tyres: Burckhardt's friction by combined slip, as in robots/car_dynamics.h. Slip is relative to a speed of at least
//   kLeastSlipSpeed, so that friction becomes viscous near rest. Below kHoldSpeed, a spring between tyre and ground
//   holds a braked car on a slope. Both together are limited to the peak friction.
// - Drive-line: open differentials, a limit of torque and one of power; brakes with a fixed distribution. Steering
//   follows Ackermann with a lag and a largest rate. A skid drive controls the speed of each wheel instead.
// - The corners of the body's box are springs with friction, upside down and against steep ground.
//
// Neglected: gyroscopic torques of wheels, camber, aligning torques, lift, delays of engine and brakes.
//
// Steps are semi-implicit (velocities first), of order one; spins and brakes are implicit. With the drive off, no step
// raises the sum of kinetic, potential and spring energy, on ground without steps.

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "base/rigid_transform.h"
#include "base/tilted_pose.h"
#include "robots/car_dynamics.h"
#include "robots/dynamics.h"

namespace sf::robots {

inline constexpr double kVehicleStep = 1e-3;    ///< [s] longest step
inline constexpr double kLeastSlipSpeed = 0.5;  ///< [m/s]
inline constexpr double kHoldSpeed = 0.1;       ///< [m/s] of tyre and wheel
inline constexpr double kBumpStiffness = 10.0;  ///< of bump stops, in those of springs
inline constexpr double kLeastSlant = 0.3;      ///< [-] cosine between strut and normal of a wheel that bears a load
inline constexpr double kLongestVehicleTick = 1.0;  ///< [s]

/// Parameters: those of the planar model, and of vertical motion. All are > 0 unless a range is stated.
struct VehicleModel {
  CarModel car;                    ///< `steer_lag` and `steer_rate` of its steering, no `torque_lag`, no `front_roll`
  double roll_inertia = 244.05;    ///< [kg m^2] about x
  double pitch_inertia = 1342.3;   ///< [kg m^2] about y
  double spring = 21'898.0;        ///< [N/m] of each wheel
  double damper = 1'459.4;         ///< [N s/m] of each wheel
  double travel = 0.08;            ///< [m] from rest to the bump stop
  double power = 55e3;             ///< [W] of the engine
  double drive_share = 1.0;        ///< [-] in [0, 1] of the front axle
  bool skid = false;               ///< wheels do not steer, and each has a motor of a quarter of the drive's limits
  double turn_factor = 1.0;        ///< skid: difference of the sides' commanded speeds, per turn and track
  glm::dvec3 box{2.1, 0.85, 1.4};  ///< [m] half length, half width and height of the body, for contacts upside down
};

/// Motion of a car, about its centre of gravity, in the world frame.
struct VehicleBody {
  glm::dvec3 p;                            ///< [m]
  base::Quaternion q;                      ///< orientation
  glm::dvec3 v;                            ///< [m/s]
  glm::dvec3 w;                            ///< [rad/s]
  std::array<double, kWheels> spin{};      ///< [rad/s] forward positive
  std::array<glm::dvec2, kWheels> hold{};  ///< [m] deflection of the tyres' hold, forward and to the left
  double steer = 0.0;                      ///< [rad] of the middle of the front axle
};

/// Inputs of the wheels in one step.
struct VehicleControls {
  double drive = 0.0;                  ///< [N m] of the engine at all driven wheels together
  double brake = 0.0;                  ///< [N m] >= 0 at all wheels together
  double steer = 0.0;                  ///< [rad] wanted
  std::array<double, kWheels> spin{};  ///< [rad/s] wanted, of skid drives
};

/// A family car, a car at 1/7 scale, or a Pioneer 3-AT: "family", "small", "pioneer".
/// @param wheelbase, track [m]
VehicleModel vehicle_preset(std::string_view name, double wheelbase, double track);

/// Reads `dynamics "car ..."`. @throws base::InputError for settings that are unknown or out of range, and for a preset
/// that does not fit `drive`
VehicleModel vehicle_of(const world::Mover& mover);

class Vehicle final : public Dynamics {
 public:
  explicit Vehicle(const VehicleModel& model, const world::Mover& mover = {});
  std::size_t state_size() const override;
  void place(const base::Report& at, std::span<double> state) const override;
  void stop(const base::Report& at, std::span<double> state) const override;
  base::Report move(const base::Report& from, const base::Twist& command, double seconds, const world::Ground& ground,
                    std::span<double> state) const override;

  const VehicleModel& model() const { return model_; }
  /// Returns a car that moves with the velocity of `at`, with rolling wheels. Its frame is that of the mover: in the
  /// middle between the axles, on the ground when the springs bear the weight.
  VehicleBody body_at(const base::Report& at) const;
  base::Report report_of(const VehicleBody& body) const;
  /// Advances by one step of `dt` [s], in (0, kVehicleStep].
  void step(VehicleBody& body, const VehicleControls& controls, double dt, const world::Ground& ground) const;
  /// Returns the speeds of the driven wheels' rims, along the car's axis, on average of a side.
  glm::dvec2 rims_of(const VehicleBody& body) const;
  /// Returns the kinetic, potential and spring energy [J].
  double energy(const VehicleBody& body, const world::Ground& ground) const;
  /// Returns the load [N] that the ground bears below a wheel.
  double load(const VehicleBody& body, std::size_t wheel, const world::Ground& ground) const;
  /// [m] by which the weight compresses a spring
  double static_compression(std::size_t wheel) const { return rest_[wheel].compression; }

 private:
  /// A wheel of a car at rest.
  struct Rest {
    glm::dvec3 p;                     ///< [m] point on the ground, from the centre of gravity
    double compression = 0.0;         ///< [m]
    double load = 0.0;                ///< [N]
    double drive = 0.0, brake = 0.0;  ///< [-] shares of the torques
    double lateral = 0.0;             ///< [-] weight of lateral slip
  };
  /// A wheel, or a corner of the body, above or on the ground.
  struct Contact {
    glm::dvec3 p, normal;      ///< from the centre of gravity, in the world frame
    double compression = 0.0;  ///< [m]
    double rate = 0.0;         ///< [m/s]
    double load = 0.0;         ///< [N] 0: in the air
  };
  /// A tyre on the ground.
  struct Tyre {
    glm::dvec3 x, y;                   ///< forward, and to the left
    double forward = 0.0, left = 0.0;  ///< [m/s] of the wheel's middle, and of the tyre
    double rim = 0.0, pitching = 0.0;  ///< [m/s], [rad/s] of the wheel, and of the body about its axle
    double along = 0.0, across = 0.0;  ///< [N s/m] viscosities
    double most = 0.0;                 ///< [N] largest friction
    double hold = 0.0;                 ///< [-] share of its hold, in [0, 1]
  };
  struct Wrench {
    glm::dvec3 force, torque;
  };
  struct Goal {
    double forward = 0.0, turn = 0.0, rate = 0.0;  ///< [m/s], [rad/s], [m/s^2]
  };
  struct State;
  double fastest_rim(const VehicleBody& body) const;  ///< [m/s] of the driven wheels
  void approach(Goal& goal, const base::Twist& command, double dt) const;
  VehicleControls controls_for(const VehicleBody& body, const Goal& goal) const;
  double bounded(double load, double closing) const;
  // The loads are those of the compressions after `dt`, at constant rates.
  Contact contact_of(const VehicleBody& body, const glm::dmat3& R, std::size_t wheel, const world::Ground& ground,
                     double dt = 0.0) const;
  glm::dvec2 heading_of(std::size_t wheel, const base::SinCos& steer) const;
  static constexpr unsigned kCorners = 8;
  static glm::dvec2 hold_rate(const Tyre& tyre, glm::dvec2 deflection, glm::dvec2 slip);
  Tyre tyre_of(const VehicleBody& body, const glm::dmat3& R, std::size_t wheel, const glm::dvec2& heading,
               const Contact& contact, double dt) const;
  glm::dvec2 hold_of(const Tyre& tyre, glm::dvec2& deflection, double dt) const;
  double spin_after(const Tyre& tyre, std::size_t wheel, const VehicleControls& controls, double spin, double load,
                    double hold, double dt) const;
  Tyre add_wheel(VehicleBody& body, const glm::dmat3& R, std::size_t wheel, const VehicleControls& controls,
                 const glm::dvec2& heading, const Contact& contact, double dt, Wrench& sum) const;
  bool lies(const VehicleBody& body, const glm::dmat3& R, const world::Ground& ground) const;
  Contact corner_of(const VehicleBody& body, const glm::dmat3& R, unsigned corner, const world::Ground& ground,
                    double dt = 0.0) const;
  void add_corners(const VehicleBody& body, const glm::dmat3& R, const world::Ground& ground, double dt,
                   Wrench& sum) const;

  VehicleModel model_;
  double max_acceleration_, max_turn_acceleration_;  ///< of the mover
  glm::dvec3 centre_;                                ///< [m] of gravity, in the mover's frame
  std::array<Rest, kWheels> rest_;
  double contact_mass_;  ///< [kg] least effective mass of the body at a tyre, with all four loaded
  double most_load_;     ///< [N] of a contact at rest
  double hold_;          ///< [N/m] stiffness of a tyre's hold
  double peak_;          ///< [-] largest friction
};

}  // namespace sf::robots
