#pragma once
// The independent answer: every beam against every segment, in `double` (or wider), nothing shared with the farm but
// the world.

#include <cstdint>
#include <span>
#include <vector>

#include "world/world.h"

namespace sf::oracle {

struct Answer {
  double range = 0.0;
  std::uint32_t model = 0xFFFFFFFFu;
  double silhouette = 0.0;  ///< [m] how near the beam passes to any segment's end point in front of, or at, its answer
};

/// All surfaces that `mover`'s sensor at height `z` may meet, with every mover at its pose.
std::vector<world::Segment> surfaces(const world::World& world, std::span<const base::Pose> poses, std::uint32_t self,
                                     double z);

/// First surface along origin + t (cos, sin), from either side.
Answer cast(std::span<const world::Segment> surfaces, base::Vec2 origin, double direction, double range_max);

}  // namespace sf::oracle
