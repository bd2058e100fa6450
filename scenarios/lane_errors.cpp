#include "scenarios/lane_errors.h"

#include <algorithm>
#include <cmath>

#include "world/path_geometry.h"

namespace sf::scenarios {

LaneErrors lane_errors(const viz::Track& track, const world::Path& path) {
  LaneErrors errors;
  double sum_abs = 0.0, count = 0.0, sum = 0.0, squares = 0.0;
  for (const base::Pose& X : track.poses) {
    const world::PathProjection at = world::project_onto(path, {X.x, X.y});
    const double distance = std::abs(at.offset);
    sum_abs += distance;
    errors.max_abs = std::max(errors.max_abs, distance);
    errors.left_lane = errors.left_lane || distance > 0.5 * path.pieces[at.piece].width;
    if (at.s < kStraight[0] || at.s > kStraight[1]) continue;
    ++count;
    sum += at.offset;
    squares += at.offset * at.offset;
  }
  if (!track.poses.empty()) errors.mean_abs = sum_abs / static_cast<double>(track.poses.size());
  if (count > 0.0) errors.amplitude = std::sqrt(2.0 * std::max(0.0, squares / count - sum * sum / (count * count)));
  return errors;
}

}  // namespace sf::scenarios
