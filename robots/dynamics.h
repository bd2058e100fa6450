#pragma once
// Motion of a robot in six degrees of freedom, in place of the kinematics of its drive (`dynamics` in world files). The
// fleet still tests contacts in the plane: along the arc from the pose before a tick to the pose after it, at the
// height before it. An obstacle stops the robot as it stops others.

#include <memory>
#include <span>

#include "base/pose.h"
#include "base/report.h"
#include "world/ground.h"
#include "world/world.h"

namespace sf::robots {

/// How one robot moves. Its methods change only `state`, which holds all that poses, tilts and planar velocities do not
/// state, so a robot may be moved by any thread and copied with its state.
class Dynamics {
 public:
  virtual ~Dynamics() = default;
  /// Returns the number of elements of `state`.
  virtual std::size_t state_size() const = 0;
  /// Sets the state of a robot that starts at `at`, or was put there by a report.
  virtual void place(const base::Report& at, std::span<double> state) const = 0;
  /// Sets the planar velocity to that of `at`, where an obstacle stopped the robot (0, or a turn in place), and keeps
  /// vertical motion, roll and pitch.
  virtual void stop(const base::Report& at, std::span<double> state) const = 0;
  /// Returns pose, tilt and velocity after `seconds` > 0, without obstacles. The yaw is in [-pi, pi].
  /// @param command within the limits of the mover's drive; finite
  virtual base::Report move(const base::Report& from, const base::Twist& command, double seconds,
                            const world::Ground& ground, std::span<double> state) const = 0;
};

using DynamicsPointer = std::shared_ptr<const Dynamics>;

}  // namespace sf::robots
