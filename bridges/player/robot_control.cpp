#include "bridges/player/robot_control.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elementary.h"
#include "robots/kinematics.h"

namespace sf::bridges::player {

namespace {

constexpr double kGain = 1.5;          // [1/s] speed per distance, and turn rate per angle
constexpr double kReached = 0.01;      // [m]
constexpr double kAhead = M_PI / 4.0;  // [rad] drives forward if the goal is within this bearing

}  // namespace

void Odometry::move(const base::Pose& X_WM) {
  X_WM_ = X_WM;
  if (!X_OW_) X_OW_ = base::inverse(X_WM);
}

void Odometry::roll(const base::ReadingBlock& encoder) {
  const double left = encoder.values[0] - std::exchange(left_, encoder.values[0]);
  const double right = encoder.values[1] - std::exchange(right_, encoder.values[1]);
  X_OM_ = robots::advance(X_OM_, {0.5 * (left + right), 0.0, (right - left) / track_}, 1.0);
}

void Odometry::set(const base::Pose& X_OM) {
  X_OM_ = X_OM;
  if (X_OW_) X_OW_ = base::compose(X_OM, base::inverse(X_WM_));
}

base::Pose Odometry::pose() const {
  if (track_ > 0.0 || !X_OW_) return X_OM_;
  return base::compose(*X_OW_, X_WM_);
}

base::Twist steer(const world::Mover& robot, const base::Pose& X_OM, const Goal& goal) {
  const auto turn_to = [&](double yaw) {
    return std::clamp(kGain * base::wrap_angle(yaw - X_OM.yaw), -robot.max_turn, robot.max_turn);
  };
  if (goal.is_heading) return {goal.speed, 0.0, turn_to(goal.X_OG.yaw)};
  const glm::dvec2 way{goal.X_OG.x - X_OM.x, goal.X_OG.y - X_OM.y};
  const double left = glm::length(way);
  if (left < kReached) return {0.0, 0.0, turn_to(goal.X_OG.yaw)};
  const double bearing = base::wrap_angle(base::atan2(way.y, way.x) - X_OM.yaw);
  const bool ahead = std::abs(bearing) < kAhead;
  return {ahead ? std::min(goal.speed, kGain * left) * base::cos(bearing) : 0.0, 0.0, turn_to(X_OM.yaw + bearing)};
}

}  // namespace sf::bridges::player
