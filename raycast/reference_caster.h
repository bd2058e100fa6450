#pragma once
// Reference caster for small worlds: intersects every beam with every surface, in `long double`. It shares the plan of
// the scans and the layout of the results with the other casters, but none of their lists, searches or arithmetic.
//
// It follows the rules of raycast/ray_caster.h. Sums of angles lose digits at large headings, so directions are
// computed from products of cosines and sines, also in `long double`.

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
  long double range = 0.0L;         ///< [m]; range_max if there is no hit
  std::uint32_t model = SF_NO_HIT;  ///< `Segment::model`
  long double sine = 1.0L;          ///< of the angle between beam and surface
};

/// Returns the beam at `bearing` [rad] of a sensor whose heading is the unit vector `heading`.
inline WideBeam wide_beam(glm::dvec2 origin, const WideBeam& heading, long double bearing) {
  const long double c = std::cos(bearing), s = std::sin(bearing);
  return {origin, heading.x * c - heading.y * s, heading.y * c + heading.x * s};
}

/// Returns the nearest surface along `beam`; the first one of those at equal range.
/// @param surfaces with ends `a` and `b` [m], whose coordinates have any floating-point type, and a `model`
template <class Surface>
WideHit nearest_surface(std::span<const Surface> surfaces, const WideBeam& beam, long double range_max) {
  constexpr long double kContact = SF_CONTACT_DISTANCE;
  WideHit nearest{range_max};
  for (const Surface& s : surfaces) {
    const long double ax = s.a.x - static_cast<long double>(beam.origin.x);
    const long double ay = s.a.y - static_cast<long double>(beam.origin.y);
    const long double bx = s.b.x - static_cast<long double>(beam.origin.x);
    const long double by = s.b.y - static_cast<long double>(beam.origin.y);
    // Two surfaces with a common end compute the same sign for it, so no beam passes between them.
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
  /// [pairs] limit of beams times surfaces per tick: a quarter of a second of work on one x86-64 core.
  static constexpr std::uint64_t kMostPairs = 100'000'000;

  /// @throws base::InputError if the product of beams and surfaces exceeds kMostPairs
  explicit ReferenceCaster(const CasterInputs& in);

  void place() override { placed_ = false; }
  bool update_outlines(const world::World& world) override;
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
  void add_outlines(const world::World& world);
  void place_movers();
  void find_visible(const Viewpoint& view, std::vector<Surface>& visible) const;
  void scan(const DueScans& due, std::size_t i, unsigned thread);

  std::vector<world::Segment> local_;  ///< walls in the world frame, then edges in the frames of their movers
  world::CopyIndex copies_;
  std::vector<std::uint32_t> movers_;  ///< mover of each; kNoMover: a wall
  std::vector<Surface> surfaces_;      ///< the same in the world frame, in this tick
  std::vector<Scratch> scratch_;       ///< per thread
  bool placed_ = false;                ///< the movers are at this tick's poses
};

}  // namespace sf::raycast
