#pragma once
// What a beam meets, in `long double`, every surface one after another: nothing shared with the farm but the world.

#include <span>
#include <vector>

#include "base/reading.h"
#include "selftest/case.h"
#include "world/world.h"

namespace sf::selftest {

struct Hit {
  Real range = 0;  ///< [m]; range_max where nothing is met
  std::uint32_t model = base::kNoHit;
  Real sine = 1;           ///< of the angle between beam and surface
  Real arm = 0;            ///< [m] from the sensor to the surface's start
  bool ambiguous = false;  ///< a free end lies within rounding of the beam, so that rounding decides
};

/// A direction that needs no sum of angles: a heading of 1e6 rad leaves a sum only 5e-14 rad, even here.
struct Beam {
  glm::dvec2 origin;
  Real x = 1, y = 0;
};
Beam beam_of(const base::Pose& X_WS, const world::Laser& laser, std::uint32_t sample);

/// The first surface in front, from either side.
Hit nearest_hit(std::span<const world::Segment> surfaces, const Beam& beam, double range_max);

/// [m] what 64 bits may be wrong by. With u = 2^-53: a beam's direction is off by at most 15 u (2.5 u of a field of
/// view of 2 pi, 6 u of turning it by the heading), the products with the surface's start by 4 u, with the surface by
/// 3 u, and the quotient divides by the sine: (4 arm + 18 range) u / sine < 2e-15 (arm + range) / sine.
double rounding(const Hit& hit);

/// Every beam of a scan without noise beside `nearest_hit`; those decided by a hair are counted in a note, not judged.
void check_scan(const world::World& world, const base::ReadingBlock& reading, Checks& checks, std::string_view what,
                std::uint32_t stride = 1);

}  // namespace sf::selftest
