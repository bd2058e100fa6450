#pragma once
// One simulated robot in its own process. It moves among the world's walls and the other robots whose states it
// receives in packets.

#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/report.h"
#include "robots/fleet.h"
#include "robots/pose_trail.h"
#include "world/world.h"

namespace sf::robots {

/// Times [ns] are those of the robot's own clock, which is non-decreasing.
class RobotBody {
 public:
  /// @param mover row of this robot; all robots start at their load poses
  /// @param forget [ns] time without a state after which another robot becomes absent; 0: never
  RobotBody(const world::World& world, std::uint32_t mover, std::int64_t forget = 0);

  /// Makes the robot move by a plug-in's dynamics (Fleet::set_dynamics).
  void set_dynamics(DynamicsPointer dynamics) { fleet_.set_dynamics(mover_, std::move(dynamics)); }

  /// Sets the state of another robot, received at `now`.
  void update_other(std::uint32_t mover, const base::Pose& X_WM, const base::Twist& velocity, std::int64_t now);

  /// Simulates until `now`, but at most half a second (a suspended process did not move). Other robots continue at
  /// their last velocity for half a second, then stop.
  void move(const base::Twist& command, std::int64_t now);
  /// Replaces `move` for a real robot: sets the body to the reported pose, at the height of the ground there.
  /// @param contact the real robot's bumper is pressed
  void follow(const base::Pose& X_WM, const base::Twist& velocity, bool contact, std::int64_t now);

  const base::Report& state() const { return fleet_.reports()[mover_]; }
  const base::Report& state(std::uint32_t mover) const { return fleet_.reports()[mover]; }
  bool contact() const { return followed_contact_.value_or(fleet_.contacts()[mover_] != 0); }
  double distance() const { return distance_; }  ///< [m] driven
  /// Returns the pose at `time`, interpolated between the last 256 moves. Earlier times give the oldest pose.
  base::TiltedPose pose_at(std::int64_t time) const { return trail_.at(time); }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  struct OtherRobot {
    base::Twist velocity;
    std::int64_t until = 0;      ///< [ns]
    std::int64_t gone = kNever;  ///< [ns] time at which it becomes absent
  };
  void advance(const base::Twist& command, const base::Report* followed, std::int64_t now);

  world::World world_;  ///< a copy, because other robots move with their reported velocities, without actuator model or
                        ///< acceleration limits
  Fleet fleet_;
  std::uint32_t mover_;
  std::int64_t forget_;                ///< [ns]; 0: never
  std::vector<OtherRobot> others_;     ///< per mover
  std::vector<base::Twist> commands_;  ///< per mover
  PoseTrail trail_;
  std::int64_t time_ = 0;
  std::optional<bool> followed_contact_;  ///< bumper of a real robot; none: contacts of the model
  double distance_ = 0.0;
};

}  // namespace sf::robots
