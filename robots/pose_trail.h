#pragma once
// The recent poses of one mover, by time.

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/tilted_pose.h"

namespace sf::robots {

/// Times [ns] are non-decreasing. Before the first `add`, the only pose is `start` at time 0.
class PoseTrail {
 public:
  explicit PoseTrail(const base::TiltedPose& start = {}) { points_[0].pose = start; }

  void add(std::int64_t time, const base::TiltedPose& pose) { points_[++added_ % points_.size()] = {time, pose}; }
  /// Interpolates between the last 256 poses: level ones linearly, others along the screw motion. Returns the oldest
  /// pose for earlier times and the newest for later ones.
  base::TiltedPose at(std::int64_t time) const;

 private:
  struct Point {
    std::int64_t time = 0;
    base::TiltedPose pose;
  };
  const Point& point(std::size_t back) const { return points_[(added_ - back) % points_.size()]; }

  std::array<Point, 256> points_;
  std::size_t added_ = 0;
};

}  // namespace sf::robots
