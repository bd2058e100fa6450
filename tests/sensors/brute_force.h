#pragma once
// Independent reference: every beam against every segment, in `long double`. It shares only the world with the farm.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "world/world.h"

namespace sf::oracle {

/// Returns all surfaces visible to a sensor of mover `self` at height `z` [m], with every mover at its pose.
std::vector<world::Segment> surfaces(const world::World& world, std::span<const base::Pose> poses, std::uint32_t self,
                                     double z);

/// Returns the surfaces of `all` within `range` [m] of `origin`, and possibly some more.
std::vector<world::Segment> within(std::span<const world::Segment> all, glm::dvec2 origin, double range);

/// [m] A beam this close to a free end may hit or miss it.
inline constexpr long double kEitherWay = 1e-6L;
/// [m] A surface this close touches the sensor.
inline constexpr long double kTouch = 1e-9L;

/// One intersection of a beam with a surface.
struct Meeting {
  long double range = 0.0L;  ///< [m]
  std::uint32_t model = 0;
  double sine = 0.0;  ///< of the angle between beam and surface
  double arm = 0.0;   ///< [m] from the sensor to the start of the segment
};

/// All valid answers for a beam.
struct Truth {
  Meeting first;               ///< in real arithmetic; range_max and 0xFFFFFFFF without a hit
  std::vector<Meeting> right;  ///< all valid answers, including `first` and its ties
  bool ambiguous = false;      ///< valid answers differ by more than 10 um: a silhouette
};

/// A wall is closed where two segments share an end (equal doubles) and lie on both sides of the beam. Surfaces within
/// kTouch return 0 for beams into them and are ignored by beams off them; the solid is on the left of a segment.
Truth judge(std::span<const world::Segment> surfaces, glm::dvec2 origin, long double direction, double range_max);

/// Returns the error [m] of 64-bit arithmetic at `meeting`, due to rounding of the beam's direction and of the products
/// with the segment's start. A surface that is edge-on within rounding may be hit anywhere along it.
double rounding(const Meeting& meeting);

}  // namespace sf::oracle
