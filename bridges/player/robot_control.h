#pragma once
// What clients of Player make one robot do, in the frame of its odometry: velocities, a heading to keep, a pose to
// reach.

#include <cstdint>
#include <optional>

#include "base/pose.h"
#include "base/reading.h"
#include "base/report.h"
#include "world/world.h"

namespace sf::bridges::player {

/// Where a robot is by its own account. Begins at 0, where the robot starts.
class Odometry {
 public:
  /// @param track [m] between the wheels, as its encoders measure it; 0: it has no encoders, and knows its way exactly
  explicit Odometry(double track) : track_(track) {}
  Odometry() = default;

  /// True pose of a tick.
  void move(const base::Pose& X_WM);
  /// A reading of the robot's encoders.
  void roll(const base::ReadingBlock& encoder);
  /// Makes `X_OM` the robot's pose, and goes on from it.
  void set(const base::Pose& X_OM);
  base::Pose pose() const;

 private:
  double track_ = 0.0;
  base::Pose X_WM_;
  std::optional<base::Pose> X_OW_;   ///< of exact odometry; none before the first tick
  base::Pose X_OM_;                  ///< by encoders
  double left_ = 0.0, right_ = 0.0;  ///< [m] rolled until X_OM_
};

/// A heading to keep at a speed, or a pose to reach.
struct Goal {
  base::Pose X_OG;
  double speed = 0.0;       ///< [m/s] negative, to keep a heading: backwards
  bool is_heading = false;  ///< only the yaw counts
};

/// The twist towards a goal. At a pose, the robot turns to its heading. @param X_OM the robot
base::Twist steer(const world::Mover& robot, const base::Pose& X_OM, const Goal& goal);

}  // namespace sf::bridges::player
