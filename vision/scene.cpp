#include "vision/scene.h"

namespace sf::vision {

base::Pose pose_at(const Patch& patch, double t) {
  const base::Pose& X_WP = patch.X_WP;
  const double dt = t - patch.time;
  return {X_WP.x + dt * patch.velocity.x, X_WP.y + dt * patch.velocity.y, X_WP.z, X_WP.yaw + dt * patch.turn};
}

}  // namespace sf::vision
