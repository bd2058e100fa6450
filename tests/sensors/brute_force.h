#pragma once
// The independent answer: every beam against every segment, in `long double`, nothing shared with the farm but the
// world.

#include <cstdint>
#include <span>
#include <string>
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

/// Those of `all` that come within `range` [m] of `origin`, and perhaps some more.
std::vector<world::Segment> within(std::span<const world::Segment> all, glm::dvec2 origin, double range);

/// First surface along origin + t (cos, sin), from either side.
Answer cast(std::span<const world::Segment> surfaces, glm::dvec2 origin, long double direction, double range_max);

/// A beam that passes a free end this near [m] may go either way.
inline constexpr long double kEitherWay = 1e-6L;
/// A surface this near [m] to the sensor touches it.
inline constexpr long double kTouch = 1e-9L;

/// One surface on the line of a beam.
struct Meeting {
  long double range = 0.0L;  ///< [m]
  std::uint32_t model = 0;
  double sine = 0.0;  ///< of the angle between beam and surface
  double arm = 0.0;   ///< [m] from the sensor to the surface's start
};

/// Everything a beam may be told.
struct Truth {
  Meeting first;               ///< in real arithmetic; range_max and 0xFFFFFFFF where nothing is met
  std::vector<Meeting> right;  ///< every right answer, `first` and its ties among them
  bool ambiguous = false;      ///< right answers differ by more than 10 um: a silhouette
};

/// Nothing of a wall may be missed where two segments share an end (the same doubles) and leave the beam on both sides.
/// Surfaces within kTouch count as 0 into them, and not at all off them; the solid is on the left of a segment.
Truth judge(std::span<const world::Segment> surfaces, glm::dvec2 origin, long double direction, double range_max);

/// What 64-bit arithmetic may be wrong by [m] at `meeting`: the beam's direction is rounded, and so are the products
/// with the surface's start. A surface seen edge-on within rounding may be met anywhere along it.
double rounding(const Meeting& meeting);

}  // namespace sf::oracle
