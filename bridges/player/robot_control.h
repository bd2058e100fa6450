#pragma once
// Executes commands of Player clients for one robot, in the frame of its odometry: velocities, a heading to keep, or a
// pose to reach.

#include <optional>

#include "base/pose.h"
#include "base/reading.h"
#include "base/report.h"
#include "world/world.h"

namespace sf::bridges::player {

/// The robot's pose by odometry. Starts at 0 at the robot's start pose.
class Odometry {
 public:
  /// @param track [m] wheel track as measured by its encoders; 0: no encoders, and exact odometry
  explicit Odometry(double track) : track_(track) {}
  Odometry() = default;

  /// Adds the true pose of a tick.
  void move(const base::Pose& X_WM);
  /// Adds a reading of the robot's encoders.
  void roll(const base::ReadingBlock& encoder);
  /// Sets the robot's pose to `X_OM` and continues from it.
  void set(const base::Pose& X_OM);
  base::Pose pose() const;

 private:
  double track_ = 0.0;
  base::Pose X_WM_;
  std::optional<base::Pose> X_OW_;   ///< of exact odometry; empty before the first tick
  base::Pose X_OM_;                  ///< by encoders
  double left_ = 0.0, right_ = 0.0;  ///< [m] travelled up to X_OM_
};

/// A heading to keep at a speed, or a pose to reach.
struct Goal {
  base::Pose X_OG;
  double speed = 0.0;       ///< [m/s] when keeping a heading; negative: backwards
  bool is_heading = false;  ///< only the yaw is used
};

/// Returns the twist towards a goal. At the goal position, the robot turns to its heading.
/// @param X_OM the robot
base::Twist steer(const world::Mover& robot, const base::Pose& X_OM, const Goal& goal);

}  // namespace sf::bridges::player
