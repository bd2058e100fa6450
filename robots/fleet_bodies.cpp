// Robots of a fleet that move by dynamics.

#include <fmt/format.h>

#include "base/error.h"
#include "robots/fleet.h"
#include "robots/kinematics.h"
#include "robots/vehicle.h"

namespace sf::robots {

void Fleet::set_dynamics(std::uint32_t row, DynamicsPointer dynamics) {
  const world::Mover& mover = world_.movers.at(row);
  const world::Variation variation = world_.variation_of(row);
  if (world_.interval > kLongestVehicleTick)
    throw base::InputError(mover.dynamics.at +
                           fmt::format("'dynamics' expects ticks of at most {:g} s; interval_sim is {:g} s",
                                       kLongestVehicleTick, world_.interval));
  if (variation.slip != 0.0 || variation.acceleration != 1.0)
    throw base::InputError(mover.dynamics.at +
                           "'dynamics' computes slip and accelerations; expected no variation of them");
  bodies_.resize(reports_.size());
  bodies_[row] = {dynamics, std::vector<double>(dynamics->state_size()), {}};
  dynamics->place(reports_[row], bodies_[row].state);
}

void Fleet::add_dynamics(std::uint32_t row) {
  const world::Mover& mover = world_.movers[row];
  if (!mover.dynamics.name.empty()) bodies_.resize(reports_.size());
  if (mover.dynamics.name == "car") set_dynamics(row, std::make_shared<Vehicle>(vehicle_of(mover), mover));
}

void Fleet::require_dynamics() const {
  if (bodies_.empty()) return;
  for (std::uint32_t row = 0; row < reports_.size(); ++row)
    if (!world_.movers[row].dynamics.name.empty() && !is_dynamic(row))
      throw base::InputError(world_.movers[row].dynamics.at + "'dynamics' of a plug-in does not move robots here");
}

/// Returns the constant velocity along an arc to the pose after the tick.
base::Twist Fleet::move_body(std::uint32_t row, const base::Twist& wanted, double seconds) {
  DynamicBody& body = bodies_[row];
  if (reported_[row] != 0) body.dynamics->place(reports_[row], body.state);
  free_discs_[row] = {};
  body.end = body.dynamics->move(reports_[row], wanted, seconds, ground_, body.state);
  return twist_between(reports_[row].X_WM, body.end.X_WM, seconds);
}

/// Ends the tick: at the computed state, or where an obstacle stopped the robot.
void Fleet::place_body(std::uint32_t row) {
  DynamicBody& body = bodies_[row];
  base::Report& report = reports_[row];
  const base::Pose &end = body.end.X_WM, before = report.X_WM;
  report.tilt = body.end.tilt;
  if (refused_[row] == 0) {
    report.X_WM = end, report.velocity = body.end.velocity, report.wheels = body.end.wheels;
  } else {
    const auto ground = [&](const base::Pose& at) {
      return ground_.height({at.x, at.y}, end.z + world::Ground::kMostStep);
    };
    report.X_WM.z = end.z + (ground(before) - ground(end));
    report.wheels = {};  // they stop with the car
    body.dynamics->stop(report, body.state);
  }
  moved_[row] = 1;
}

}  // namespace sf::robots
