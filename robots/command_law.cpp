#include "robots/command_law.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "robots/kinematics.h"

namespace sf::robots {

namespace {

constexpr double kMaxSpeed = 500.0;  // [mm/s] limit of the Open Interface's drive command
constexpr int kMaxRadius = 2000;     // [mm]

/// Rounds to whole [mm/s], within kMaxSpeed.
double whole_speed(double metres_per_second) {
  return std::clamp(std::rint(1e3 * metres_per_second), -kMaxSpeed, kMaxSpeed);
}

/// Returns the radius [mm] as Player 3's driver for the Create computes it (create_comms.c, `rad_mm /= 2`); its integer
/// division truncates towards zero. The robot has no radius 0, so 0 means the sharpest turn.
int radius_mm(double speed_mm, double turn) {
  const double asked = std::clamp(std::rint(speed_mm / turn), -1e9, 1e9);
  const int radius = std::clamp(static_cast<int>(asked) / 2, -kMaxRadius, kMaxRadius);
  if (radius != 0) return radius;
  return (speed_mm < 0.0) == (turn < 0.0) ? 1 : -1;
}

base::Twist apply_create_driver(const world::Mover& mover, double forward, double turn) {
  if (turn == 0.0) return {1e-3 * whole_speed(forward), 0.0, 0.0};
  const double half_track = 0.5 * mover.track;
  if (forward == 0.0) return {0.0, 0.0, 1e-3 * whole_speed(half_track * turn) / half_track};
  const double speed_mm = whole_speed(forward);
  const int radius = radius_mm(speed_mm, turn);
  const double speed = 1e-3 * speed_mm;
  const bool spins = std::abs(radius) == 1;
  if (spins) return {0.0, 0.0, speed / (radius * half_track)};
  return {speed, 0.0, speed / (1e-3 * radius)};
}

}  // namespace

base::Twist apply_actuator_model(const world::Mover& mover, const base::Twist& command) {
  const base::Twist v = finite(command);
  return mover.actuator_model == world::ActuatorModel::player_create ? apply_create_driver(mover, v.forward, v.turn)
                                                                     : v;
}

}  // namespace sf::robots
