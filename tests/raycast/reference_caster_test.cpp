// Compares the reference caster with exact arithmetic: rational numbers, and 100 decimal digits for directions.
//
// These tests cover the parts of ray casting. Whole scenes are tested in tests/sensors (casters_test.cpp,
// host_cast_test.cpp, laser_*_test.cpp, ...), since they need sensors: lasers, sonars and their carriers.

#include "raycast/reference_caster.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>

#include "raycast/casters.h"
#include "raycast/ray_caster.h"
#include "robots/fleet.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/chance.h"

namespace sf::raycast {
namespace {

using Exact = boost::multiprecision::cpp_rational;
using Digits100 = boost::multiprecision::cpp_bin_float_100;
using trial::Chance;

world::Segment wall(glm::dvec2 a, glm::dvec2 b, std::uint32_t model = 7) {
  world::Segment s;
  s.a = a, s.b = b, s.model = model;
  return s;
}

struct ExactHit {
  Exact range;
  std::uint32_t model = SF_NO_HIT;
};

/// Applies the rules of raycast/ray_caster.h to the given beam, without rounding.
ExactHit exact_hit(std::span<const world::Segment> walls, const WideBeam& beam, double range_max) {
  const Exact dx(beam.x), dy(beam.y), ox(beam.origin.x), oy(beam.origin.y), contact(SF_CONTACT_DISTANCE);
  ExactHit nearest{Exact(range_max)};
  for (const world::Segment& s : walls) {
    const Exact ax = Exact(s.a.x) - ox, ay = Exact(s.a.y) - oy, ex = Exact(s.b.x) - Exact(s.a.x),
                ey = Exact(s.b.y) - Exact(s.a.y);
    const Exact side_a = dx * ay - dy * ax, side_b = side_a + dx * ey - dy * ex, denominator = ex * dy - ey * dx;
    if (denominator == 0 || side_a.sign() * side_b.sign() > 0) continue;
    const Exact t = (ex * ay - ey * ax) / denominator;
    if (t <= contact && !(denominator > 0 && t >= -contact)) continue;
    const Exact range = t > 0 ? t : Exact(0);
    if (range < nearest.range) nearest = {range, s.model};
  }
  return nearest;
}

/// Returns the error bound [m] of a hit: `exact_bound` with the unit roundoff of `long double` and the hit's own sine.
long double bound_of(const WideHit& hit, double extent) { return 0x1p-64L * 40.0L * extent / hit.sine; }

/// Walls from a millimetre to 10 km long, up to 10 000 km from the world's origin.
TEST(ReferenceCaster, IsExactAmongRandomWalls) {
  Chance chance(5);
  std::size_t met = 0;
  for (const double far : {0.0, 1e3, 1e7})
    for (const double size : {1e-3, 1.0, 1e4}) {
      const glm::dvec2 eye = far * chance.in_square(1.0);
      std::vector<world::Segment> walls;
      for (std::uint32_t i = 0; i < 12; ++i) {
        const glm::dvec2 a = eye + size * chance.in_square(1.0);
        walls.push_back(wall(a, a + size * chance.in_square(1.0), i));
      }
      for (int i = 0; i < 60; ++i) {
        const WideBeam beam = wide_beam(eye, {}, chance.between(-4.0, 4.0));
        const WideHit hit = nearest_surface(std::span<const world::Segment>(walls), beam, 2.0 * size);
        const ExactHit exact = exact_hit(walls, beam, 2.0 * size);
        ASSERT_EQ(hit.model, exact.model) << far << " m away, size " << size << ", beam " << i;
        const auto error = static_cast<long double>(Exact(hit.range) - exact.range);
        EXPECT_LE(std::fabs(error), bound_of(hit, 4.0 * size)) << far << " m away, size " << size << ", beam " << i;
        met += hit.model != SF_NO_HIT;
      }
    }
  EXPECT_GT(met, 200u);
}

/// Beams to the corners of a closed outline, and to adjacent numbers, meet one of its walls.
TEST(ReferenceCaster, BeamsDoNotPassThroughCorners) {
  Chance chance(6);
  for (int round = 0; round < 40; ++round) {
    const glm::dvec2 eye = 1e4 * chance.in_square(1.0);
    std::vector<glm::dvec2> corners;
    for (int i = 0; i < 9; ++i)
      corners.push_back(eye + base::rotate(2.0 * M_PI * i / 9.0, {chance.between(1.0, 3.0), 0.0}));
    std::vector<world::Segment> walls;
    for (std::size_t i = 0; i < corners.size(); ++i) walls.push_back(wall(corners[i], corners[(i + 1) % 9]));
    for (const glm::dvec2& corner : corners)
      for (const long double turn : {0.0L, 1e-19L, -1e-19L}) {
        const long double wx = static_cast<long double>(corner.x) - eye.x;
        const long double wy = static_cast<long double>(corner.y) - eye.y, length = std::hypot(wx, wy);
        const WideBeam beam{eye, wx / length - turn * wy, wy / length + turn * wx};
        const WideHit hit = nearest_surface(std::span<const world::Segment>(walls), beam, 50.0L);
        EXPECT_NEAR(static_cast<double>(hit.range), static_cast<double>(length), 1e-12);
      }
  }
}

TEST(ReferenceCaster, DirectionsAreAccurateAtLargeHeadings) {
  Chance chance(7);
  for (const double most : {4.0, 1e3, 1e6})
    for (int i = 0; i < 50; ++i) {
      const double yaw = chance.between(-most, most), bearing = chance.between(-M_PI, M_PI);
      const WideBeam heading{{}, std::cos(static_cast<long double>(yaw)), std::sin(static_cast<long double>(yaw))};
      const WideBeam beam = wide_beam({}, heading, bearing);
      const Digits100 angle = Digits100(yaw) + Digits100(bearing);
      EXPECT_LE(abs(Digits100(beam.x) - cos(angle)), Digits100(4 * 0x1p-64L)) << yaw << ", " << bearing;
      EXPECT_LE(abs(Digits100(beam.y) - sin(angle)), Digits100(4 * 0x1p-64L)) << yaw << ", " << bearing;
    }
}

/// One surface, and a beam from the origin along x with a range of 8 m.
TEST(ReferenceCaster, EdgeCases) {
  struct Case {
    const char* why;
    glm::dvec2 a, b;
    double range;
  };
  const Case cases[] = {
      {"from the right", {2.0, 1.0}, {2.0, -1.0}, 2.0},
      {"from the left", {2.0, -1.0}, {2.0, 1.0}, 2.0},
      {"an end belongs to its surface", {2.0, 0.0}, {2.0, 1.0}, 2.0},
      {"the next number off an end", {2.0, 5e-324}, {2.0, 1.0}, 8.0},
      {"along the beam", {2.0, 0.0}, {3.0, 0.0}, 8.0},
      {"without length", {2.0, 0.0}, {2.0, 0.0}, 8.0},
      {"behind", {-2.0, 1.0}, {-2.0, -1.0}, 8.0},
      {"at the longest range", {8.0, 1.0}, {8.0, -1.0}, 8.0},
      {"touching, into it", {1e-10, 1.0}, {1e-10, -1.0}, 1e-10},
      {"touching, off it", {1e-10, -1.0}, {1e-10, 1.0}, 8.0},
      {"just behind, into it", {-1e-10, 1.0}, {-1e-10, -1.0}, 0.0},
      {"just beyond touching", {1.1e-9, 1.0}, {1.1e-9, -1.0}, 1.1e-9},
  };
  for (const Case& c : cases) {
    const world::Segment s = wall(c.a, c.b);
    const WideHit hit = nearest_surface(std::span(&s, 1), WideBeam{}, 8.0L);
    EXPECT_EQ(static_cast<double>(hit.range), c.range) << c.why;
    EXPECT_EQ(hit.model, c.range < 8.0 ? 7u : SF_NO_HIT) << c.why;
  }
  const std::vector<world::Segment> twins{wall({2.0, 1.0}, {2.0, -1.0}, 1), wall({2.0, 1.0}, {2.0, -1.0}, 2)};
  EXPECT_EQ(nearest_surface(std::span<const world::Segment>(twins), WideBeam{}, 8.0L).model, 1u) << "the first counts";
}

/// 1 000 beams and 100 000 walls are exactly at the limit.
TEST(ReferenceCaster, RejectsLargeWorldsAtLoad) {
  base::ThreadPool thread_pool(1);
  world::World world;
  world.file = "large.world";
  for (int i = 0; i < 100'000; ++i) world.walls.push_back(wall({i, 0.0}, {i, 1.0}));
  world.movers.emplace_back();
  const std::vector<base::Report> states = robots::states_at_load(world);
  const auto make = [&] {
    Scanner scanner;
    scanner.scan.samples = 1'000;
    const SensorContext context{.world = world,
                                .device = host_device(),
                                .thread_pool = thread_pool,
                                .states = states,
                                .scene = {.caster = &reference_caster}};
    const RayCaster caster(context, world, {scanner});
  };
  EXPECT_NO_THROW(make());
  world.walls.push_back(wall({0.0, 0.0}, {0.0, 1.0}));
  EXPECT_EQ(refusal_of(make),
            "large.world: the caster 'reference' intersects every beam with every surface: 1000 beams and 100001 "
            "surfaces are more than 100 million pairs; use fewer robots or beams, a smaller world, or the caster "
            "'host'");
}

}  // namespace
}  // namespace sf::raycast
