#include "robots/pose_trail.h"

#include <algorithm>

namespace sf::robots {

namespace {

base::Pose between(const base::Pose& a, const base::Pose& b, double part) {
  return {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), a.z + part * (b.z - a.z),
          base::wrap_angle(a.yaw + part * base::wrap_angle(b.yaw - a.yaw))};
}

}  // namespace

base::Pose PoseTrail::at(std::int64_t time) const {
  const std::size_t kept = std::min(added_ + 1, points_.size());
  if (time >= point(0).time) return point(0).X_WM;
  for (std::size_t back = 1; back < kept; ++back) {
    const Point& earlier = point(back);
    const Point& later = point(back - 1);
    if (earlier.time > time) continue;
    const auto part = static_cast<double>(time - earlier.time) / static_cast<double>(later.time - earlier.time);
    return between(earlier.X_WM, later.X_WM, part);
  }
  return point(kept - 1).X_WM;
}

}  // namespace sf::robots
