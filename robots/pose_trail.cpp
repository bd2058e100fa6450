#include "robots/pose_trail.h"

#include <algorithm>

namespace sf::robots {

namespace {

base::TiltedPose between(const base::TiltedPose& from, const base::TiltedPose& to, double part) {
  if (!base::is_level(from.tilt) || !base::is_level(to.tilt)) return base::screw_between(from, to, part);
  const base::Pose &a = from.X, &b = to.X;
  return {{a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), a.z + part * (b.z - a.z),
           base::wrap_angle(a.yaw + part * base::wrap_angle(b.yaw - a.yaw))}};
}

}  // namespace

base::TiltedPose PoseTrail::at(std::int64_t time) const {
  const std::size_t kept = std::min(added_ + 1, points_.size());
  if (time >= point(0).time) return point(0).pose;
  for (std::size_t back = 1; back < kept; ++back) {
    const Point& earlier = point(back);
    const Point& later = point(back - 1);
    if (earlier.time > time) continue;
    const auto part = static_cast<double>(time - earlier.time) / static_cast<double>(later.time - earlier.time);
    return between(earlier.pose, later.pose, part);
  }
  return point(kept - 1).pose;
}

}  // namespace sf::robots
