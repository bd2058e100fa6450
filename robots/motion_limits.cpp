#include "robots/motion_limits.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "robots/kinematics.h"

namespace sf::robots {

base::Twist limit_kinematics(const world::Mover& mover, const base::Twist& command) {
  base::Twist v = finite(command);
  v.turn = std::clamp(v.turn, -mover.max_turn, mover.max_turn);
  if (mover.drive == world::Drive::omni) {
    const double speed = base::hypot(v.forward, v.left);
    if (speed > mover.max_forward) {
      v.forward *= mover.max_forward / speed;
      v.left *= mover.max_forward / speed;
    }
    return v;
  }
  v.left = 0.0;
  v.forward = std::clamp(v.forward, -mover.max_forward, mover.max_forward);
  if (mover.drive == world::Drive::car) {
    const double sharpest = std::abs(v.forward) * base::tan(kMaxSteer) / mover.wheelbase;
    v.turn = std::clamp(v.turn, -sharpest, sharpest);
  }
  return v;
}

base::Twist limit_acceleration(const world::Mover& mover, const base::Twist& now, const base::Twist& wanted,
                               double dt) {
  if (mover.max_acceleration == HUGE_VAL && mover.max_turn_acceleration == HUGE_VAL) return wanted;
  base::Twist v = wanted;
  const glm::dvec2 change{wanted.forward - now.forward, wanted.left - now.left};
  const double most = mover.max_acceleration * dt;
  if (const double needed = glm::length(change); needed > most) {
    v.forward = now.forward + most / needed * change.x;
    v.left = now.left + most / needed * change.y;
  }
  const double most_turn = mover.max_turn_acceleration * dt;
  if (std::abs(wanted.turn - now.turn) > most_turn)
    v.turn = now.turn + std::copysign(most_turn, wanted.turn - now.turn);
  return limit_kinematics(mover, v);
}

}  // namespace sf::robots
