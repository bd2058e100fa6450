#pragma once
// Reference ray casting in `long double` over all surfaces, independent of the farm except for the world.

#include <span>
#include <vector>

#include "base/reading.h"
#include "selftest/fixture.h"

namespace sf::selftest {

struct Hit {
  Real range = 0;  ///< [m]; range_max without a hit
  std::uint32_t model = base::kNoHit;
  Real sine = 1;           ///< of the angle between the beam and the surface
  Real arm = 0;            ///< [m] from the sensor to the surface's start point
  bool ambiguous = false;  ///< whether a free end is within rounding of the beam, so that either result is correct
};

/// A beam whose direction is computed without a sum of angles: at a heading of 1e6 rad even a sum of this type is
/// accurate only to 5e-14 rad.
struct Beam {
  glm::dvec2 origin;
  Real x = 1, y = 0;
};
Beam beam_of(const base::Pose& X_WS, const sensors::LaserSettings& laser, std::uint32_t sample);

/// Returns the nearest surface along the beam, hit from either side.
Hit nearest_hit(std::span<const world::Segment> surfaces, const Beam& beam, double range_max);

/// [m] Error bound of 64-bit ray casting. With u = 2^-53: a beam's direction is off by at most 15 u (2.5 u from a field
/// of view of 2 pi, 6 u from rotation by the heading), the product with the surface's start by 4 u, with the surface by
/// 3 u, and the quotient divides by the sine: (4 arm + 18 range) u / sine < 2e-15 (arm + range) / sine.
double rounding(const Hit& hit);

/// Compares every beam of a scan without noise with `nearest_hit`. Counts ambiguous beams only in a note.
/// @param stride checks every stride-th beam
void check_scan(const TestFarm& test, const base::ReadingBlock& reading, Checks& checks, std::string_view what,
                std::uint32_t stride = 1);

}  // namespace sf::selftest
