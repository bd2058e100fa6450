// Beams along walls, through corners, from the face of a wall, and from inside blocks.

#include <fmt/format.h>

#include "selftest/exact_ray_cast.h"
#include "selftest/fixture.h"
#include "selftest/suite.h"

namespace sf::selftest {

namespace {

/// A laser next to the start of a 100 m wall hits it halfway at a grazing angle; another wall is behind it.
void grazing(Fixture& fixture, Checks& checks) {
  const sensors::LaserSettings eye = laser(1, 0.0, 1000.0);
  for (double angle = 1e-1; angle > 0.5e-9; angle *= 0.1) {
    double off = 0.0, allowed = 0.0;
    for (const double far : {0.0, 1e5})
      for (const double tilt : {0.0, 0.3, 2.0}) {
        const auto at = [&](double x, double y) { return glm::dvec2{far, -far} + base::rotate(tilt, {x, y}); };
        world::World world;
        add_wall(world, at(0.0, 0.0), at(100.0, 0.0));
        add_wall(world, at(100.0, -1.0), at(100.0, 60.0));
        const glm::dvec2 p = at(0.0, 50.0 * std::tan(angle));
        add_laser_mover(world, {p.x, p.y, 0.0, tilt - angle}, eye);
        const TestFarm test = fixture.measure(world);
        check_scan(test, test.readings[0], checks, fmt::format("at {:.0e} rad, {:g} m away", angle, far));
        checks.equal(test.readings[0].hits[0], 0u, "the wall that is grazed is named");
        const Hit met = nearest_hit(test.world->walls, beam_of(test.readings[0].X_WS, eye, 0), eye.range_max);
        off = std::max(off, static_cast<double>(std::fabs(Real{test.readings[0].values[0]} - met.range)));
        allowed = std::max(allowed, rounding(met));
      }
    checks.note(fmt::format("50 m ahead at {:.0e} rad: {:.1e} m off, {:.1e} m allowed", angle, off, allowed));
  }
}

/// Beams along x, parallel to a wall or collinear with it: they hit the wall across their end.
void parallel(Fixture& fixture, Checks& checks) {
  for (const double beside : {1.0, 1e-3, 1e-6, 1e-8, 1e-300, 0.0, -1e-8, -1.0})
    for (const double from : {-2.0, 0.0, 3.0}) {
      world::World world;
      add_wall(world, {0.0, 0.0}, {10.0, 0.0});
      add_wall(world, {12.0, -5.0}, {12.0, 5.0});
      add_laser_mover(world, {from, beside, 0.0, 0.0}, laser(1, 0.0, 100.0));
      const TestFarm test = fixture.measure(world);
      checks.same(test.readings[0].values[0], 12.0 - from, fmt::format("{:g} m aside, from {:g}", beside, from));
      checks.equal(test.readings[0].hits[0], 1u, "the wall across is named");
    }
}

/// From inside a polygon at each corner: the range is the distance of the corner, whichever of its walls is hit.
void corners(Fixture& fixture, Checks& checks) {
  for (const int count : {3, 7, 64, 1000})
    for (const double far : {0.0, 1e7}) {
      world::World world;
      std::vector<glm::dvec2> ring, wide;
      for (int i = 0; i < count; ++i) {
        const glm::dvec2 out = base::rotate(-i * kTurn / count, {1.0, 0.0});
        ring.push_back(glm::dvec2{far, -far} + 4.0 * out);
        wide.push_back(glm::dvec2{far, -far} + 6.0 * glm::dvec2{out.x, -out.y});
      }
      add_outline(world, wide);
      add_outline(world, ring);
      const glm::dvec2 eye{far + 0.3125, -far - 0.4375};
      for (const glm::dvec2& corner : ring)
        add_laser_mover(world, {eye.x, eye.y, 0.0, std::atan2(corner.y - eye.y, corner.x - eye.x)},
                        laser(3, 2e-9, 20.0));
      const TestFarm test = fixture.measure(world);
      for (const base::ReadingBlock& r : test.readings) {
        check_scan(test, r, checks, fmt::format("{} corners, {:g} m away", count, far));
        const Real dx = Real{ring[r.mover].x} - eye.x, dy = Real{ring[r.mover].y} - eye.y;
        // Walls of a ring of 1 000 are hit at nearly a right angle, those of a triangle at 20 degrees or more.
        checks.near(r.values[1], std::hypot(dx, dy), 5e-14, "the middle beam ends in the corner", r.mover);
      }
    }
}

/// Two blocks touch at one corner: a beam along the diagonal between them ends there.
void touching_corners(Fixture& fixture, Checks& checks) {
  for (const double far : {0.0, 1e5, 1e7}) {
    world::World world;
    add_block(world, {far - 1.0, far - 1.0}, {far, far});
    add_block(world, {far, far}, {far + 1.0, far + 1.0});
    add_laser_mover(world, {far + 0.75, far - 0.75, 0.0, 0.75 * M_PI}, laser(1, 0.0, 8.0));
    const TestFarm test = fixture.measure(world);
    checks.near(test.readings[0].values[0], 0.75L * std::sqrt(2.0L), 1e-14, fmt::format("{:g} m away", far));
  }
}

/// From a wall's inner face: 0 towards the wall, and the distance of the opposite wall away from it.
void from_on_a_wall(Fixture& fixture, Checks& checks) {
  for (const double far : {0.0, 1e5, 1e7}) {
    world::World world;
    add_room(world, {far, far}, 4.0);
    add_laser_mover(world, {far, far + 1.5, 0.0, M_PI}, laser(180, M_PI - 0.01, 20.0));
    add_laser_mover(world, {far, far + 1.5, 0.0, 0.0}, laser(180, M_PI - 0.01, 20.0));
    const TestFarm test = fixture.measure(world);
    for (std::size_t i = 0; i < 180; ++i) {
      checks.same(test.readings[0].values[i], 0.0, fmt::format("into it, {:g} m away", far), i);
      checks.holds(test.readings[0].hits[i] != base::kNoHit, "the touched wall is named", i);
      world::World rest = *test.world;
      std::erase_if(rest.walls, [&](const world::Segment& s) { return s.a.x == far && s.b.x == far; });
      const Hit met = nearest_hit(
          rest.walls, beam_of(test.readings[1].X_WS, laser(180, M_PI - 0.01, 20.0), static_cast<std::uint32_t>(i)),
          20.0);
      checks.near(test.readings[1].values[i], met.range, rounding(met), fmt::format("off it, {:g} m away", far), i);
    }
  }
}

/// From inside three overlapping blocks: the range is that of the nearest surface of any block.
void from_inside(Fixture& fixture, Checks& checks) {
  for (const double far : {0.0, 1e5, 1e7}) {
    world::World world;
    add_block(world, {far - 1.0, far - 1.0}, {far + 1.0, far + 1.0});
    add_block(world, {far - 0.5, far - 0.5}, {far + 2.0, far + 0.25});
    add_block(world, {far - 0.125, far - 3.0}, {far + 0.5, far + 3.0});
    add_laser_mover(world, {far + 0.0625, far + 0.03125, 0.0, 0.1}, laser(721, kTurn, 10.0));
    const TestFarm test = fixture.measure(world);
    check_scan(test, test.readings[0], checks, fmt::format("{:g} m away", far));
  }
}

constexpr Case kBeamCases[] = {
    {"beams", "grazing", "m", "walls met at 0.1 to 1e-9 rad: rounding of 64 bits divided by the sine, 2e-4 m at 1e-9",
     grazing},
    {"beams", "parallel", "m",
     "beams along a wall, 1 m to 1e-300 m away from it and in line with it: the wall across, bitwise", parallel},
    {"beams", "shared-corners", "m",
     "beams into the corners of polygons: the corner's distance, rounding over the walls' sine", corners},
    {"beams", "touching-corners", "m",
     "between two blocks that touch in one corner: its distance, rounding at 45 degrees", touching_corners},
    {"beams", "from-on-a-wall", "m", "exactly 0 into the wall, the other walls away from it within rounding",
     from_on_a_wall},
    {"beams", "from-inside", "m", "inside overlapping blocks: the nearest surface, within rounding", from_inside},
};

}  // namespace

std::span<const Case> beam_cases() { return kBeamCases; }

}  // namespace sf::selftest
