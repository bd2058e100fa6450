#pragma once
// True distances of a robot from the middle of its lane.

#include "viz/tracks.h"
#include "world/world.h"

namespace sf::scenarios {

struct LaneErrors {
  double mean_abs = 0.0;   ///< [m] of the robot's origin from the lane's middle
  double max_abs = 0.0;    ///< [m]
  double amplitude = 0.0;  ///< [m] of the oscillation on `kStraight`: sqrt(2) standard deviations; 0 without poses
  bool left_lane = false;  ///< whether the origin crossed an edge
};

/// [m] along the path: the straight part of the test path before its bend, after the return from the start.
inline constexpr double kStraight[2] = {1.0, 2.6};

/// Returns zeros for a track without poses.
LaneErrors lane_errors(const viz::Track& track, const world::Path& path);

}  // namespace sf::scenarios
