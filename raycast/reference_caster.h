#pragma once
// The reference: every beam against every surface, in `long double`, for small worlds. It shares the plan of the scans
// and the layout of the results with the other casters, but no list, no search and no arithmetic.
//
// Its rules are those of raycast/ray_caster.h. Sums of angles lose digits at large headings, so directions are products
// of cosines and sines, in this type like all else.

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "raycast/caster.h"

namespace sf::raycast {

/// A beam: origin [m] and unit vector.
struct WideBeam {
  glm::dvec2 origin;
  long double x = 1.0L, y = 0.0L;
};

/// The nearest surface along a beam.
struct WideHit {
  long double range = 0.0L;         ///< [m]; range_max without a hit
  std::uint32_t model = SF_NO_HIT;  ///< `Segment::model`
  long double sine = 1.0L;          ///< of the angle between beam and surface
};

/// The direction of `bearing` [rad] in the frame of a sensor with the unit vector `heading`.
inline WideBeam wide_beam(glm::dvec2 origin, const WideBeam& heading, long double bearing) {
  const long double c = std::cos(bearing), s = std::sin(bearing);
  return {origin, heading.x * c - heading.y * s, heading.y * c + heading.x * s};
}

/// Among surfaces of equal range, the first counts.
/// @param surfaces with ends `a` and `b`, of coordinates in any floating-point type [m], and a `model`
template <class Surface>
WideHit nearest_surface(std::span<const Surface> surfaces, const WideBeam& beam, long double range_max) {
  constexpr long double kContact = SF_CONTACT_DISTANCE;
  WideHit nearest{range_max};
  for (const Surface& s : surfaces) {
    const long double ax = s.a.x - static_cast<long double>(beam.origin.x);
    const long double ay = s.a.y - static_cast<long double>(beam.origin.y);
    const long double bx = s.b.x - static_cast<long double>(beam.origin.x);
    const long double by = s.b.y - static_cast<long double>(beam.origin.y);
    // Signs that two surfaces with a common end compute alike, so that no beam passes between them.
    const long double side_a = beam.x * ay - beam.y * ax, side_b = beam.x * by - beam.y * bx;
    const bool crosses = (side_a >= 0 && side_b <= 0) || (side_a <= 0 && side_b >= 0);
    if (!crosses) continue;
    const long double ex = static_cast<long double>(s.b.x) - s.a.x, ey = static_cast<long double>(s.b.y) - s.a.y;
    const long double denominator = ex * beam.y - ey * beam.x;
    if (denominator == 0) continue;
    const long double t = (ex * ay - ey * ax) / denominator;
    const bool meets = t > kContact || (denominator > 0 && t >= -kContact);
    if (!meets || std::fmax(t, 0.0L) >= nearest.range) continue;
    nearest = {std::fmax(t, 0.0L), s.model, std::fabs(denominator) / std::hypot(ex, ey)};
  }
  return nearest;
}

class ReferenceCaster : public Caster {
 public:
  /// [pairs] of a beam and a surface per tick: a quarter of a second of work on one core (x86-64).
  static constexpr std::uint64_t kMostPairs = 100'000'000;

  /// @throws base::InputError when all beams and all surfaces make more than kMostPairs
  explicit ReferenceCaster(const CasterInputs& in);

  void place() override { placed_ = false; }
  bool prepare(const DueScans& due, bool cast) override;
  SensorStats stats() const override { return {}; }

 private:
  struct Point {
    long double x, y;  ///< [m] world
  };
  struct Surface {
    Point a, b;
    std::uint32_t model;
  };
  struct Scratch {
    std::vector<Surface> surfaces;
    std::vector<double> ranges;
    std::vector<std::uint32_t> models;
    std::vector<std::uint8_t> grazes;
  };

  void add(const world::Segment& s, std::uint32_t mover);
  void place_movers();
  void find_visible(const Viewpoint& view, std::vector<Surface>& visible) const;
  void scan(const DueScans& due, std::size_t i, unsigned thread);

  std::vector<world::Segment> local_;  ///< walls in the world, then edges in the frames of their movers
  std::vector<std::uint32_t> movers_;  ///< of each; kNoMover: a wall
  std::vector<Surface> surfaces_;      ///< of each, in the world, in this tick
  std::vector<double> load_z_;         ///< [m] heights of movers at load; they do not change (2.5-D world)
  std::vector<Scratch> scratch_;       ///< per thread
  bool placed_ = false;                ///< the movers are at this tick's poses
};

}  // namespace sf::raycast
