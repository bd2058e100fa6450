#pragma once
// One simulated robot in a process of its own. It moves among the world's walls and the other robots, as far as their
// states are known from packets.

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/report.h"
#include "robots/fleet.h"
#include "robots/pose_trail.h"
#include "world/world.h"

namespace sf::robots {

/// Times are those of the robot's own clock [ns], which is non-decreasing.
class RobotBody {
 public:
  /// @param mover row of this robot; all robots start at their poses at load
  /// @param forget [ns] time without a state after which another robot becomes absent; 0: never
  RobotBody(const world::World& world, std::uint32_t mover, std::int64_t forget = 0);

  /// State of another robot, received at `now`.
  void update_other(std::uint32_t mover, const base::Pose& X_WM, const base::Twist& velocity, std::int64_t now);

  /// Moves until `now`, by half a second at most (a suspended process did not move). Other robots continue with their
  /// last velocity for half a second, then stop.
  void move(const base::Twist& command, std::int64_t now);
  /// In place of `move`: the body is where a real robot says that it is.
  /// @param contact the real robot's bumper is pressed
  void follow(const base::Pose& X_WM, const base::Twist& velocity, bool contact, std::int64_t now);

  const base::Report& state() const { return fleet_.reports()[mover_]; }
  const base::Report& state(std::uint32_t mover) const { return fleet_.reports()[mover]; }
  bool contact() const { return followed_contact_.value_or(fleet_.contacts()[mover_] != 0); }
  double distance() const { return distance_; }  ///< [m] driven
  /// Pose at `time`, interpolated between the last 256 moves; before these, the oldest pose.
  base::Pose pose_at(std::int64_t time) const { return trail_.at(time); }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  struct OtherRobot {
    base::Twist velocity;
    std::int64_t until = 0;      ///< [ns]
    std::int64_t gone = kNever;  ///< [ns] time at which it becomes absent
  };
  void advance(const base::Twist& command, const base::Report* followed, std::int64_t now);

  world::World world_;  ///< a copy: other robots move with their reported velocities, without actuator model or limits
                        ///< of acceleration
  Fleet fleet_;
  std::uint32_t mover_;
  std::int64_t forget_;                ///< [ns]; 0: never
  std::vector<OtherRobot> others_;     ///< per mover
  std::vector<base::Twist> commands_;  ///< per mover
  PoseTrail trail_;
  std::int64_t time_ = 0;
  std::optional<bool> followed_contact_;  ///< of a real robot; none: of the model
  double distance_ = 0.0;
};

}  // namespace sf::robots
